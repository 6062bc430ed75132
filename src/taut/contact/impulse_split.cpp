#include "taut/contact/impulse_split.h"

#include <algorithm>
#include <array>

#include "taut/constraint/constraint_set.h"

namespace taut {
namespace {

// Gram-Schmidt on the normals, n = Q R for those that count.
struct Basis {
  std::array<Vec3, 3> q;
  std::array<std::size_t, 3> which{};  // the normal that gave each q
  Mat3 r = Mat3::Zero();
  int rank = 0;
};

Basis basis_of(std::span<const Vec3> normals) {
  Basis basis;
  for (std::size_t k = 0; k < normals.size() && basis.rank < 3; ++k) {
    Vec3 rest = normals[k];
    Vec3 along = Vec3::Zero();
    // twice, so that nearly parallel normals still give an orthogonal basis
    for (int pass = 0; pass < 2; ++pass)
      for (int c = 0; c < basis.rank; ++c) {
        const double share = basis.q[c].dot(rest);
        along[c] += share;
        rest -= share * basis.q[c];
      }
    const double length = rest.norm();
    if (length < parallel_tolerance) continue;
    along[basis.rank] = length;
    basis.r.col(basis.rank) = along;
    basis.q[basis.rank] = rest / length;
    basis.which[basis.rank] = k;
    ++basis.rank;
  }
  return basis;
}

}  // namespace

Vec3 split_impulse(std::span<const Vec3> normals, const Vec3& j, std::span<double> lambda) {
  std::ranges::fill(lambda, 0.0);
  const Basis basis = basis_of(normals);
  Vec3 tangential = j, share = Vec3::Zero();
  for (int c = 0; c < basis.rank; ++c) {
    share[c] = basis.q[c].dot(j);
    tangential -= share[c] * basis.q[c];
  }
  for (int c = basis.rank - 1; c >= 0; --c) {
    for (int later = c + 1; later < basis.rank; ++later)
      share[c] -= basis.r(c, later) * share[later];
    share[c] /= basis.r(c, c);
    lambda[basis.which[c]] = share[c];
  }
  return tangential;
}

Vec3 tangential_part(std::span<const Vec3> normals, const Vec3& a) {
  const Basis basis = basis_of(normals);
  Vec3 tangential = a;
  for (int c = 0; c < basis.rank; ++c) tangential -= basis.q[c].dot(a) * basis.q[c];
  return tangential;
}

}  // namespace taut
