#include "taut/base/huge_pages.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace taut {

void prefer_huge_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  // Whole large pages only: what follows the array may belong to somebody else.
  if (const std::size_t whole = bytes / huge_page_bytes * huge_page_bytes; whole > 0)
    madvise(begin, whole, MADV_HUGEPAGE);
#endif
}

namespace {

std::align_val_t alignment_of(std::size_t bytes) {
  constexpr std::size_t cache_line = 64;
  return std::align_val_t{bytes >= huge_page_bytes ? huge_page_bytes : cache_line};
}

}  // namespace

void* allocate_large(std::size_t bytes) {
  void* begin = ::operator new(bytes, alignment_of(bytes));
  if (bytes >= huge_page_bytes) prefer_huge_pages(begin, bytes);
  return begin;
}

void release_large(void* begin, std::size_t bytes) {
  ::operator delete(begin, alignment_of(bytes));
}

}  // namespace taut
