#pragma once
// A plain array that begins on a cache line, or where it is large on a large page, and is not initialised: touching hundreds of megabytes
// only to overwrite them costs more than the solves.

#include <cstddef>
#include <memory>
#include <new>

#include "taut/base/huge_pages.h"
#include "taut/base/types.h"

namespace taut {

template <class T>
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(Offset size) : size_(size) {
    const std::size_t bytes = static_cast<std::size_t>(size) * sizeof(T);
    const std::align_val_t alignment{bytes >= huge_page_bytes ? huge_page_bytes : cache_line};
    values_ = {static_cast<T*>(::operator new (bytes, alignment)), Release{alignment}};
    if (bytes >= huge_page_bytes) prefer_huge_pages(values_.get(), bytes);
  }
  T* data() { return values_.get(); }
  const T* data() const { return values_.get(); }
  Offset size() const { return size_; }
  Offset bytes() const { return size_ * static_cast<Offset>(sizeof(T)); }

 private:
  static constexpr std::size_t cache_line = 64;
  struct Release {
    std::align_val_t alignment{cache_line};
    void operator()(T* p) const { ::operator delete (p, alignment); }
  };
  std::unique_ptr<T, Release> values_;
  Offset size_ = 0;
};

}  // namespace taut
