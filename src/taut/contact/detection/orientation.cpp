#include "taut/contact/detection/orientation.h"

#include <cmath>

#include "taut/contact/detection/expansion.h"

namespace taut::detail {

namespace {

constexpr double u = 0x1p-53;
// Products below this may have lost digits to underflow; then the exact value is computed.
constexpr double underflow_error = 1e-250;

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Expansion m[3][3];
  for (int i = 0; i < 3; ++i) {
    m[0][i] = Expansion::difference(a[i], d[i]);
    m[1][i] = Expansion::difference(b[i], d[i]);
    m[2][i] = Expansion::difference(c[i], d[i]);
  }
  Expansion determinant;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    determinant = determinant + m[0][i] * (m[1][j] * m[2][k] - m[1][k] * m[2][j]);
  }
  return determinant.sign();
}

}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 ad = a - d, bd = b - d, cd = c - d;
  double determinant = 0.0, size = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double plus = bd[j] * cd[k], minus = bd[k] * cd[j];
    determinant += ad[i] * (plus - minus);
    size += std::abs(ad[i]) * (std::abs(plus) + std::abs(minus));
  }
  // Each of the six products of three differences has passed at most 8 roundings: three
  // differences, two products, a subtraction, two additions (the first adds to 0 exactly). `size`
  // is too small by at most as much, so 8 u (1 + 8 u) size would do.
  const double error = 10.0 * u * size + underflow_error;
  if (determinant > error) return 1;
  if (determinant < -error) return -1;
  return exact_orientation(a, b, c, d);
}

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double plus = (a[i] - c[i]) * (b[j] - c[j]), minus = (a[j] - c[j]) * (b[i] - c[i]);
  const double determinant = plus - minus;
  // Two differences, a product and a subtraction: at most 4 roundings.
  const double error = 6.0 * u * (std::abs(plus) + std::abs(minus)) + underflow_error;
  if (determinant > error) return 1;
  if (determinant < -error) return -1;
  const Expansion exact = Expansion::difference(a[i], c[i]) * Expansion::difference(b[j], c[j]) -
                          Expansion::difference(a[j], c[j]) * Expansion::difference(b[i], c[i]);
  return exact.sign();
}

}  // namespace taut::detail
