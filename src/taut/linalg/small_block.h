#pragma once
// Products of n x n row-major blocks, n known to the compiler: the arithmetic of the incomplete factorisations.

namespace taut {

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
