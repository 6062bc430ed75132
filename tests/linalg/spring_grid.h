// A grid of unit masses and random springs to the twelve neighbours of a cloth's node, as a matrix
// of 3x3 blocks; and the dense matrix that leaving springs out, or parallelograms in their place,
// makes of one.

#pragma once

#include "linalg/random_matrix.h"
#include "taut/linalg/parallelogram.h"

namespace taut::test {

// A without the springs that are not kept, and with the parallelograms in their place: from
// springs, not from how blocks are added.
inline Eigen::MatrixXd dense_core(const BlockCsr& a, std::span<const std::uint8_t> kept,
                                  std::span<const Parallelogram> replaced) {
  const BlockPattern& p = *a.pattern;
  const Eigen::MatrixXd all = dense(a);
  Eigen::MatrixXd result = all;
  const auto spring = [&](Index i, Index j, const Mat3& b) {
    result.block<3, 3>(3 * i, 3 * i) += b, result.block<3, 3>(3 * j, 3 * j) += b;
    result.block<3, 3>(3 * i, 3 * j) -= b, result.block<3, 3>(3 * j, 3 * i) -= b;
  };
  for (Index i = 0; i < p.rows(); ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
      if (const Index j = p.column[k]; j > i && !kept[k])
        spring(i, j, all.block<3, 3>(3 * i, 3 * j));
  for (const Parallelogram& of : replaced) {
    const Mat3 b = -all.block<3, 3>(3 * of.a, 3 * of.c);
    spring(of.a, of.b, b), spring(of.b, of.c, b), spring(of.c, of.d, b), spring(of.d, of.a, b),
        spring(of.b, of.d, -b);
  }
  return result;
}

struct SpringGrid {
  Index nu, nv;
  BlockCsr a;
  std::vector<std::uint8_t> sides;  // grid edges, and the diagonal

  SpringGrid(Random& random, Index u_nodes, Index v_nodes, double stiffness = 10.0)
      : nu(u_nodes), nv(v_nodes) {
    std::vector<std::vector<Index>> columns(static_cast<std::size_t>(nu * nv));
    const auto for_links = [&](auto visit) {
      for (Index v = 0; v < nv; ++v)
        for (Index u = 0; u < nu; ++u)
          for (const auto& [du, dv] : {std::pair{1, 0}, {0, 1}, {1, 1}, {-1, 1}, {2, 0}, {0, 2}})
            if (u + du >= 0 && u + du < nu && v + dv < nv) visit(node(u, v), node(u + du, v + dv));
    };
    for_links([&](Index i, Index j) { columns[i].push_back(j), columns[j].push_back(i); });
    for (auto& row : columns) std::ranges::sort(row);
    a = BlockCsr(make_pattern(columns, 3));
    for (Index i = 0; i < nu * nv; ++i) add(i, i, Mat3::Identity());
    for_links([&](Index i, Index j) {
      const Vec3 e = random.direction();
      const Mat3 spring = stiffness * random.uniform(0.1, 1.0) * e * e.transpose();
      add(i, i, spring), add(j, j, spring), add(i, j, -spring), add(j, i, -spring);
    });
    const BlockPattern& p = *a.pattern;
    for (Index i = 0; i < p.rows(); ++i)
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
        const Index j = p.column[k];
        sides.push_back(std::abs(i % nu - j % nu) + std::abs(i / nu - j / nu) <= 1);
      }
  }

  Index node(Index u, Index v) const { return v * nu + u; }
  void add(Index i, Index j, const Mat3& block) {
    for (Index r = 0; r < 3; ++r)
      for (Index c = 0; c < 3; ++c)
        a.block(i, a.pattern->find(i, j))[r * a.pattern->width(i) + c] += block(r, c);
  }
};

}  // namespace taut::test
