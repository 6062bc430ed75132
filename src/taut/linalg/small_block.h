#pragma once
// Small row-major blocks. Products of n x n ones, n known to the compiler: the arithmetic of the
// incomplete factorisations. And a copy.

#include "taut/base/simd.h"
#include "taut/base/types.h"

namespace taut {

// A 3x3 block out of a row's panel of `width` columns (BlockCsr), rounded to T. What a row reads
// and writes as a fourth number is in the panel, and written over by the next row.
template <class T>
TAUT_ALWAYS_INLINE void copy_block_3(const double* from, Index width, T* to) {
  typedef double Doubles __attribute__((vector_size(32), aligned(8), may_alias));
  typedef T Four __attribute__((vector_size(4 * sizeof(T)), aligned(sizeof(T)), may_alias));
  for (Index r = 0; r < 2; ++r)
    *reinterpret_cast<Four*>(to + 3 * r) =
        __builtin_convertvector(*reinterpret_cast<const Doubles*>(from + r * width), Four);
  for (Index c = 0; c < 3; ++c) to[6 + c] = static_cast<T>(from[2 * width + c]);
}

// c -= a b
template <int n>
inline void subtract_product(const double* a, const double* b, double* c) {
  for (int r = 0; r < n; ++r)
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j) c[n * r + j] -= a[n * r + k] * b[n * k + j];
}

// c -= a bᵀ
template <int n>
inline void subtract_product_transposed(const double* a, const double* b, double* c) {
  for (int r = 0; r < n; ++r)
    for (int j = 0; j < n; ++j) {
      double sum = 0.0;
      for (int k = 0; k < n; ++k) sum += a[n * r + k] * b[n * j + k];
      c[n * r + j] -= sum;
    }
}

// c = a b
template <int n>
inline void product(const double* a, const double* b, double* c) {
  for (int r = 0; r < n; ++r)
    for (int j = 0; j < n; ++j) {
      double sum = 0.0;
      for (int k = 0; k < n; ++k) sum += a[n * r + k] * b[n * k + j];
      c[n * r + j] = sum;
    }
}

}  // namespace taut
