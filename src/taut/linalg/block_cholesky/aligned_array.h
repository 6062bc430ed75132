#pragma once
// A plain array that begins on a cache line and is not initialised: touching hundreds of megabytes only to overwrite them costs more than
// the solves.

#include <cstddef>
#include <memory>
#include <new>

#include "taut/base/types.h"

namespace taut {

template <class T>
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(Offset size)
      : values_(static_cast<T*>(::operator new (static_cast<std::size_t>(size) * sizeof(T), std::align_val_t{alignment}))), size_(size) {}
  T* data() { return values_.get(); }
  const T* data() const { return values_.get(); }
  Offset size() const { return size_; }
  Offset bytes() const { return size_ * static_cast<Offset>(sizeof(T)); }

 private:
  static constexpr std::size_t alignment = 64;
  struct Release {
    void operator()(T* p) const { ::operator delete (p, std::align_val_t{alignment}); }
  };
  std::unique_ptr<T, Release> values_;
  Offset size_ = 0;
};

}  // namespace taut
