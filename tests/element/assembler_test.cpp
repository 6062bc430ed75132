// The assembled matrix and right-hand side against dense ones made from spring_response.

#include "taut/element/assembler.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <set>

#include "element/random_springs.h"
#include "taut/base/parallel.h"
#include "taut/element/cloth_springs.h"

namespace taut {
namespace {

struct Sheet {
  Sheet(Index nu, Index nv, BendModel bend) : random(5) {
    const GridShape shape{.nu = nu, .nv = nv};
    const TriangleMesh mesh = make_grid(shape);
    SpringMaterial material{.k_stretch = 60.0,
                            .k_shear = 3.0,
                            .k_bend = 0.5,
                            .k_damp_stretch = 0.4,
                            .k_damp_shear = 0.2,
                            .k_damp_bend = 0.1};
    material.bend_model = bend;
    if (bend == BendModel::choi_ko) material.k_bend = 1e-3;
    owned = grid_springs(shape, mesh.positions, material, 0, "sheet");
    for (const auto& model : owned) models.push_back(model.get());
    nodes = shape.node_count();
    x = mesh.positions;
    for (Vec3& place : x) place += random.vector(0.15 / nu);
    v = random.vectors(nodes, 1.0), p = random.vectors(nodes, 1.0), q = random.vectors(nodes, 1.0);
    for (Index i = 0; i < nodes; ++i) {
      masses.push_back(random.uniform(0.01, 0.1));
      const Vec3 a = random.vector(1.0);
      damping.push_back(a * a.transpose() + random.uniform(0.0, 1.0) * Mat3::Identity());
    }
  }
  ForceRequest request(bool matrix) const {
    ForceRequest r;
    r.x = x, r.v = v;
    r.force = 0.7;
    r.matrix_stiffness = matrix ? 0.3 : 0.0;
    r.matrix_damping = matrix ? 0.2 : 0.0;
    r.stiffness_operand = p;
    r.damping_operand = q;
    return r;
  }
  std::vector<ForceRequest> requests(const std::vector<bool>& implicit) const {
    std::vector<ForceRequest> all;
    for (const bool matrix : implicit) all.push_back(request(matrix));
    return all;
  }

  test::Random random;
  std::vector<std::unique_ptr<SpringModel>> owned;
  std::vector<const ForceModel*> models;
  Index nodes = 0;
  std::vector<Vec3> x, v, p, q;
  std::vector<double> masses;
  std::vector<Mat3> damping;
};

struct Dense {
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
};

// Springs of the models chosen, without masses; `mask(i, j)`: whether a spring between these
// counts.
template <class Mask>
Dense dense_springs(const Sheet& s, const std::vector<bool>& implicit, const Mask& mask) {
  Dense sum{Eigen::MatrixXd::Zero(3 * s.nodes, 3 * s.nodes), Eigen::VectorXd::Zero(3 * s.nodes)};
  for (std::size_t m = 0; m < s.owned.size(); ++m)
    for (const auto& [i, j, parameters] : s.owned[m]->springs()) {
      if (!mask(i, j)) continue;
      const SpringResponse r =
          spring_response(s.owned[m]->law(), parameters, s.x[j] - s.x[i], s.v[j] - s.v[i]);
      const Vec3 g =
          0.7 * r.force + r.stiffness * (s.p[i] - s.p[j]) + r.damping * (s.q[i] - s.q[j]);
      sum.b.segment<3>(3 * i) += g;
      sum.b.segment<3>(3 * j) -= g;
      if (!implicit[m]) continue;
      const Mat3 block = 0.3 * r.stiffness + 0.2 * r.damping;
      sum.a.block<3, 3>(3 * i, 3 * i) += block;
      sum.a.block<3, 3>(3 * j, 3 * j) += block;
      sum.a.block<3, 3>(3 * i, 3 * j) -= block;
      sum.a.block<3, 3>(3 * j, 3 * i) -= block;
    }
  return sum;
}

constexpr auto all_springs = [](Index, Index) { return true; };

Eigen::MatrixXd dense_of(const BlockCsr& a) {
  Eigen::MatrixXd dense(a.dofs(), a.dofs());
  for (Index r = 0; r < a.dofs(); ++r)
    for (Index c = 0; c < a.dofs(); ++c) dense(r, c) = a.at(r, c);
  return dense;
}

TEST(Assembler, EqualsADenseAssembly) {
  for (const BendModel bend : {BendModel::linear, BendModel::choi_ko})
    for (const std::vector<bool>& implicit :
         {std::vector<bool>{true, true, true}, {true, false, false}, {false, true, true}}) {
      const Sheet s(5, 4, bend);
      Assembler assembler(s.nodes, s.models, implicit);
      BlockCsr a(assembler.pattern());
      std::vector<Vec3> b(static_cast<std::size_t>(s.nodes));
      // Twice, so that what an earlier call left behind would show.
      assembler.assemble(s.requests(implicit), {s.masses, 3.0, {}, 0.0}, a, b);
      assembler.assemble(s.requests(implicit), {s.masses, 1.5, s.damping, 0.4}, a, b);
      Dense expected = dense_springs(s, implicit, all_springs);
      for (Index i = 0; i < s.nodes; ++i)
        expected.a.block<3, 3>(3 * i, 3 * i) +=
            1.5 * s.masses[i] * Mat3::Identity() + 0.4 * s.damping[i];
      const Eigen::MatrixXd found = dense_of(a);
      EXPECT_LT((found - expected.a).norm(), 1e-13 * expected.a.norm());
      EXPECT_LT(
          (Eigen::Map<const Eigen::VectorXd>(flat(b).data(), 3 * s.nodes) - expected.b).norm(),
          1e-13 * expected.b.norm());
      EXPECT_TRUE(found == found.transpose()) << "not symmetric to the last bit";
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(found).eigenvalues()[0], 1.5 * 0.01);
    }
}

TEST(Assembler, ModelThatAsksForNoMatrixLeavesNothingBehind) {
  const Sheet s(5, 4, BendModel::linear);
  Assembler assembler(s.nodes, s.models, {true, true, true});
  BlockCsr a(assembler.pattern());
  std::vector<Vec3> b(static_cast<std::size_t>(s.nodes));
  assembler.assemble(s.requests({true, true, true}), {s.masses, 1.0, {}, 0.0}, a, b);
  assembler.assemble(s.requests({false, true, false}), {s.masses, 0.0, {}, 0.0}, a, b);
  const Dense expected = dense_springs(s, {false, true, false}, all_springs);
  EXPECT_LT((dense_of(a) - expected.a).norm(), 1e-13 * expected.a.norm());
}

// The pattern: a node itself and those it shares an implicit spring with.
TEST(Assembler, PatternHasTheImplicitSpringsOnly) {
  const Sheet s(6, 5, BendModel::linear);
  for (const std::vector<bool>& implicit :
       {std::vector<bool>{true, true, true}, {true, false, false}}) {
    const Assembler assembler(s.nodes, s.models, implicit);
    std::set<std::pair<Index, Index>> expected;
    for (Index i = 0; i < s.nodes; ++i) expected.emplace(i, i);
    for (std::size_t m = 0; m < 3; ++m)
      for (const Spring& spring : s.owned[m]->springs()) {
        if (!implicit[m]) continue;
        expected.emplace(spring.i, spring.j);
        expected.emplace(spring.j, spring.i);
      }
    std::set<std::pair<Index, Index>> found;
    const BlockPattern& p = *assembler.pattern();
    for (Index i = 0; i < p.rows(); ++i)
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) found.emplace(i, p.column[k]);
    EXPECT_EQ(found, expected);
  }
}

TEST(Assembler, CoreIsStretchAndTheDiagonal) {
  const Sheet s(6, 5, BendModel::linear);
  const Assembler assembler(s.nodes, s.models, {true, true, true});
  std::set<std::pair<Index, Index>> stretch;
  for (const Spring& spring : s.owned[0]->springs())
    stretch.insert({spring.i, spring.j}), stretch.insert({spring.j, spring.i});
  const std::vector<std::uint8_t> mask = assembler.core_mask(ForceClass::stretch);
  const BlockPattern& p = *assembler.pattern();
  ASSERT_EQ(mask.size(), static_cast<std::size_t>(p.blocks()));
  for (Index i = 0; i < p.rows(); ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
      EXPECT_EQ(mask[k], i == p.column[k] || stretch.count({i, p.column[k]}))
          << i << ", " << p.column[k];
}

// Largest eigenvalues of the blocks, whatever the state.
TEST(Assembler, BlockBoundsHoldInEveryState) {
  for (const BendModel bend : {BendModel::linear, BendModel::choi_ko}) {
    Sheet s(6, 5, bend);
    Assembler assembler(s.nodes, s.models, {true, true, true});
    const BlockPattern& p = *assembler.pattern();
    const std::vector<double> bounds = assembler.block_bounds(0.3, 0.2);
    std::vector<double> largest(bounds.size(), 0.0);
    for (int state = 0; state < 40; ++state) {
      // From nearly collapsed to far stretched.
      for (Vec3& x : s.x) x = s.random.vector(0.02 * std::pow(2.0, state % 8));
      BlockCsr a(assembler.pattern());
      std::vector<Vec3> b(static_cast<std::size_t>(s.nodes));
      assembler.assemble(s.requests({true, true, true}), {s.masses, 1.0, {}, 0.0}, a, b);
      for (Index i = 0; i < p.rows(); ++i)
        for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
          if (k == p.diagonal[i]) {
            EXPECT_EQ(bounds[k], 0.0);
            continue;
          }
          Mat3 block;
          for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) block(r, c) = -a.block(i, k)[r * p.width(i) + c];
          largest[k] =
              std::max(largest[k], Eigen::SelfAdjointEigenSolver<Mat3>(block).eigenvalues()[2]);
        }
    }
    for (std::size_t k = 0; k < bounds.size(); ++k)
      EXPECT_LE(largest[k], bounds[k] * (1.0 + 1e-12));
    if (bend != BendModel::linear) continue;
    // 0.3 k + 0.2 k_d of a stretch, a shear and a bend spring; reached, to within the damping's
    // direction.
    EXPECT_DOUBLE_EQ(bounds[p.find(7, 8)], 0.3 * 60.0 + 0.2 * 0.4);
    EXPECT_DOUBLE_EQ(bounds[p.find(7, 14)], 0.3 * 3.0 + 0.2 * 0.2);
    EXPECT_DOUBLE_EQ(bounds[p.find(7, 9)], 0.3 * 0.5 + 0.2 * 0.1);
    EXPECT_NEAR(largest[p.find(7, 8)], bounds[p.find(7, 8)], 1e-9);
  }
}

TEST(Assembler, CountsTheElementsOfACore) {
  const Sheet s(6, 5, BendModel::linear);
  const Assembler assembler(s.nodes, s.models, {true, true, true});
  EXPECT_EQ(assembler.elements_of(assembler.core_mask(ForceClass::stretch)).inside,
            s.models[0]->block_count());
  EXPECT_EQ(assembler.elements_of(assembler.core_mask(ForceClass::bend)).inside,
            s.models[2]->block_count());
  const std::vector<std::uint8_t> all(static_cast<std::size_t>(assembler.pattern()->blocks()), 1);
  EXPECT_EQ(assembler.elements_of(all).inside,
            s.models[0]->block_count() + s.models[1]->block_count() + s.models[2]->block_count());
}

TEST(Assembler, DeterministicForAnyNumberOfThreads) {
  const Sheet s(90, 80, BendModel::choi_ko);
  const std::vector<bool> implicit{true, true, true};
  Assembler assembler(s.nodes, s.models, implicit);
  const int usual = thread_count();
  LargeVector<double> values;
  std::vector<Vec3> rhs;
  double energy = 0.0;
  for (const int threads : {1, 2, 3, 4}) {
    set_thread_count(threads);
    BlockCsr a(assembler.pattern());
    std::vector<Vec3> b(static_cast<std::size_t>(s.nodes));
    assembler.assemble(s.requests(implicit), {s.masses, 1.0, s.damping, 0.1}, a, b);
    const double joule =
        s.owned[0]->energy(s.x) + s.owned[1]->energy(s.x) + s.owned[2]->energy(s.x);
    if (threads == 1) values = a.values, rhs = b, energy = joule;
    EXPECT_TRUE(a.values == values && b == rhs && joule == energy) << threads << " threads";
  }
  set_thread_count(usual);
  EXPECT_GT(energy, 0.0);
}

}  // namespace
}  // namespace taut
