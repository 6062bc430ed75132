#pragma once
// A plain array that begins on a cache line, or where it is large on a large page, and is not
// initialised: touching hundreds of megabytes only to overwrite them costs more than the solves.

#include <memory>

#include "taut/base/huge_pages.h"
#include "taut/base/types.h"

namespace taut {

template <class T>
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(Offset size) : size_(size) {
    const std::size_t bytes = static_cast<std::size_t>(size) * sizeof(T);
    values_ = {static_cast<T*>(allocate_large(bytes)), Release{bytes}};
  }
  T* data() { return values_.get(); }
  const T* data() const { return values_.get(); }
  Offset size() const { return size_; }
  Offset bytes() const { return size_ * static_cast<Offset>(sizeof(T)); }

 private:
  struct Release {
    std::size_t bytes = 0;
    void operator()(T* p) const { release_large(p, bytes); }
  };
  std::unique_ptr<T, Release> values_;
  Offset size_ = 0;
};

}  // namespace taut
