// The assembled matrix and right-hand side against dense ones made from spring_response.

#include "taut/force/assembler.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <set>

#include "force/random_springs.h"
#include "taut/base/parallel.h"
#include "taut/force/cloth_springs.h"

namespace taut {
namespace {

struct Sheet {
  Sheet(Index nu, Index nv, BendModel bend) : random(5) {
    const GridShape shape{.nu = nu, .nv = nv};
    const TriangleMesh mesh = make_grid(shape);
    SpringMaterial material{
        .k_stretch = 60.0, .k_shear = 3.0, .k_bend = 0.5, .k_damp_stretch = 0.4, .k_damp_shear = 0.2, .k_damp_bend = 0.1};
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

// Springs of the models chosen, without masses; `mask(i, j)`: whether a spring between these counts.
template <class Mask>
Dense dense_springs(const Sheet& s, const std::vector<bool>& implicit, const Mask& mask) {
  Dense sum{Eigen::MatrixXd::Zero(3 * s.nodes, 3 * s.nodes), Eigen::VectorXd::Zero(3 * s.nodes)};
  for (std::size_t m = 0; m < s.owned.size(); ++m)
    for (const auto& [i, j, parameters] : s.owned[m]->springs()) {
      if (!mask(i, j)) continue;
      const SpringResponse r = spring_response(s.owned[m]->law(), parameters, s.x[j] - s.x[i], s.v[j] - s.v[i]);
      const Vec3 g = 0.7 * r.force + r.stiffness * (s.p[i] - s.p[j]) + r.damping * (s.q[i] - s.q[j]);
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
    for (const std::vector<bool>& implicit : {std::vector<bool>{true, true, true}, {true, false, false}, {false, true, true}}) {
      const Sheet s(5, 4, bend);
      Assembler assembler(s.nodes, s.models, implicit);
      BlockCsr a(assembler.pattern());
      std::vector<Vec3> b(static_cast<std::size_t>(s.nodes));
      // Twice, so that what an earlier call left behind would show.
      assembler.assemble(s.requests(implicit), {s.masses, 3.0, {}, 0.0}, a, b);
      assembler.assemble(s.requests(implicit), {s.masses, 1.5, s.damping, 0.4}, a, b);
      Dense expected = dense_springs(s, implicit, all_springs);
      for (Index i = 0; i < s.nodes; ++i) expected.a.block<3, 3>(3 * i, 3 * i) += 1.5 * s.masses[i] * Mat3::Identity() + 0.4 * s.damping[i];
      const Eigen::MatrixXd found = dense_of(a);
      EXPECT_LT((found - expected.a).norm(), 1e-13 * expected.a.norm());
      EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(flat(b).data(), 3 * s.nodes) - expected.b).norm(), 1e-13 * expected.b.norm());
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
  for (const std::vector<bool>& implicit : {std::vector<bool>{true, true, true}, {true, false, false}}) {
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
  for (const Spring& spring : s.owned[0]->springs()) stretch.insert({spring.i, spring.j}), stretch.insert({spring.j, spring.i});
  const std::vector<std::uint8_t> mask = assembler.core_mask(ForceClass::stretch);
  const BlockPattern& p = *assembler.pattern();
  ASSERT_EQ(mask.size(), static_cast<std::size_t>(p.blocks()));
  for (Index i = 0; i < p.rows(); ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
      EXPECT_EQ(mask[k], i == p.column[k] || stretch.count({i, p.column[k]})) << i << ", " << p.column[k];
}

TEST(Assembler, RemainderRatioIsTheLargestEigenvalueOfTheRestsDiagonalBlocks) {
  for (const BendModel bend : {BendModel::linear, BendModel::choi_ko}) {
    Sheet s(6, 5, bend);
    Assembler assembler(s.nodes, s.models, {true, true, true});
    BlockCsr a(assembler.pattern());
    std::vector<Vec3> b(static_cast<std::size_t>(s.nodes));
    assembler.assemble(s.requests({true, true, true}), {s.masses, 1.0, {}, 0.0}, a, b);
    const std::vector<std::uint8_t> mask = assembler.core_mask(ForceClass::stretch);
    const Dense rest = dense_springs(s, {false, true, true}, all_springs);
    double rho = 0.0;
    for (Index i = 0; i < s.nodes; ++i) {
      const Mat3 block = rest.a.block<3, 3>(3 * i, 3 * i);
      rho = std::max(rho, Eigen::SelfAdjointEigenSolver<Mat3>(block).eigenvalues()[2] / s.masses[i]);
    }
    EXPECT_NEAR(assembler.remainder_ratio(mask, s.masses), rho, 1e-6 * rho);
    EXPECT_GE(assembler.remainder_ratio(mask, s.masses), rho) << "a bound must not be missed by rounding";
    const std::vector<std::uint8_t> everything(mask.size(), 1);
    EXPECT_EQ(assembler.remainder_ratio(everything, s.masses), 0.0);
  }
}

// A bend spring over a stretch edge (two nodes joined by both) keeps its block: it belongs to the core.
TEST(Assembler, SpringWhoseBlockSurvivesIsNotInTheRemainder) {
  const std::vector<Vec3> x{Vec3::Zero(), Vec3(1.2, 0, 0), Vec3(0, 1.3, 0)}, v(3, Vec3::Zero());
  const SpringModel stretch(ForceClass::stretch, SpringLawKind::linear, {{0, 1, {.rest_length = 1.0, .stiffness = 10.0}}});
  const SpringModel bend(ForceClass::bend, SpringLawKind::linear,
                         {{0, 1, {.rest_length = 1.0, .stiffness = 7.0}}, {0, 2, {.rest_length = 1.0, .stiffness = 2.0}}});
  Assembler assembler(3, {&stretch, &bend}, {true, true});
  BlockCsr a(assembler.pattern());
  std::vector<Vec3> b(3);
  ForceRequest request;
  request.x = x, request.v = v, request.matrix_stiffness = 1.0;
  const std::vector<double> masses(3, 0.5);
  assembler.assemble(std::vector{request, request}, {masses, 1.0, {}, 0.0}, a, b);
  EXPECT_NEAR(assembler.remainder_ratio(assembler.core_mask(ForceClass::stretch), masses), 2.0 / 0.5, 1e-5);
}

TEST(Assembler, DeterministicForAnyNumberOfThreads) {
  const Sheet s(90, 80, BendModel::choi_ko);
  const std::vector<bool> implicit{true, true, true};
  Assembler assembler(s.nodes, s.models, implicit);
  const int usual = thread_count();
  std::vector<double> values;
  std::vector<Vec3> rhs;
  double rho = 0.0, energy = 0.0;
  for (const int threads : {1, 2, 3, 4}) {
    set_thread_count(threads);
    BlockCsr a(assembler.pattern());
    std::vector<Vec3> b(static_cast<std::size_t>(s.nodes));
    assembler.assemble(s.requests(implicit), {s.masses, 1.0, s.damping, 0.1}, a, b);
    const double ratio = assembler.remainder_ratio(assembler.core_mask(ForceClass::stretch), s.masses);
    const double joule = s.owned[0]->energy(s.x) + s.owned[1]->energy(s.x) + s.owned[2]->energy(s.x);
    if (threads == 1) values = a.values, rhs = b, rho = ratio, energy = joule;
    EXPECT_TRUE(a.values == values && b == rhs && ratio == rho && joule == energy) << threads << " threads";
  }
  set_thread_count(usual);
  EXPECT_GT(energy, 0.0);
}

}  // namespace
}  // namespace taut
