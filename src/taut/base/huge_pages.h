#pragma once
// Large arrays on large pages.

#include <cstddef>
#include <new>
#include <vector>

namespace taut {

// Arrays of at least this many bytes are worth it, and should begin on such an address: 2 MiB, the
// size of a large page on x86-64.
inline constexpr std::size_t huge_page_bytes = std::size_t{1} << 21;

// Asks the system to back this memory, not touched so far, by large pages: an array of tens of
// megabytes that is read from end to end needs thousands of page translations otherwise. Where the
// system knows of no such thing, nothing happens.
void prefer_huge_pages(void* begin, std::size_t bytes);

// Memory that begins on a cache line, or where it is large on a large page, and lies on such pages.
// Throws std::bad_alloc.
void* allocate_large(std::size_t bytes);
void release_large(void* begin, std::size_t bytes);

// For vectors whose place in memory matters: the values of matrices.
template <class T>
struct LargeAllocator {
  using value_type = T;
  LargeAllocator() = default;
  template <class U>
  LargeAllocator(const LargeAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(allocate_large(n * sizeof(T))); }
  void deallocate(T* p, std::size_t n) { release_large(p, n * sizeof(T)); }
  friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }
};
template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace taut
