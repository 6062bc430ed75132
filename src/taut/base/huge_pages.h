#pragma once
// Large arrays on large pages.

#include <cstddef>

namespace taut {

// Arrays of at least this many bytes are worth it, and should begin on such an address: 2 MiB, the size of a large page on x86-64.
inline constexpr std::size_t huge_page_bytes = std::size_t{1} << 21;

// Asks the system to back this memory, not touched so far, by large pages: an array of tens of megabytes that is read from end to end needs
// thousands of page translations otherwise. Where the system knows of no such thing, nothing happens.
void prefer_huge_pages(void* begin, std::size_t bytes);

}  // namespace taut
