#pragma once
// Four numbers at any address: three of a node and one more, nobody's. What reads or writes them
// says where the fourth one is.

#include "taut/base/simd.h"

namespace taut {

template <class T>
struct Quad;
template <>
struct Quad<float> {
  using Type = float __attribute__((vector_size(16), aligned(4), may_alias));
};
template <>
struct Quad<double> {
  using Type = double __attribute__((vector_size(32), aligned(8), may_alias));
};

template <class T>
TAUT_ALWAYS_INLINE typename Quad<T>::Type& quad(T* p) {
  return *reinterpret_cast<typename Quad<T>::Type*>(p);
}
template <class T>
TAUT_ALWAYS_INLINE const typename Quad<T>::Type& quad(const T* p) {
  return *reinterpret_cast<const typename Quad<T>::Type*>(p);
}

// The last row of a 3x3 block, without the number behind it, which another thread may be writing.
template <class T>
TAUT_ALWAYS_INLINE void get_last_row(const T* block, typename Quad<T>::Type& to) {
  const typename Quad<T>::Type from = quad(block + 5);
  to = __builtin_shufflevector(from, from, 1, 2, 3, 3);
}

// The first three of them: two at once.
template <class T>
TAUT_ALWAYS_INLINE void put_three(const typename Quad<T>::Type& from, T* to) {
  __builtin_memcpy(to, &from, 2 * sizeof(T));
  to[2] = from[2];
}

}  // namespace taut
