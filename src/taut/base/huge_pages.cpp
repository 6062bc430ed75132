#include "taut/base/huge_pages.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace taut {

void prefer_huge_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  // Whole large pages only: what follows the array may belong to somebody else.
  if (const std::size_t whole = bytes / huge_page_bytes * huge_page_bytes; whole > 0) madvise(begin, whole, MADV_HUGEPAGE);
#endif
}

}  // namespace taut
