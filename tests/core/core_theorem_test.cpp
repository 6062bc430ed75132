// The bounds of docs/mathematics.md, 5 for every family of elements: dense eigenvalues of P⁻¹A on
// a thousand random, bent, stretched and compressed states each, for the core with the rest's
// diagonal and without the rest.

#include <gtest/gtest.h>

#include "core/hinged_sheet.h"
#include "taut/base/parallel.h"

namespace taut::test {
namespace {

constexpr int states = 1000;
constexpr Index nu = 3, nv = 2;

struct Family {
  std::string name;
  std::unique_ptr<ForceModel> outside;
};

// What may be outside the core of stretch springs on a sheet of six nodes.
Family family(const std::string& name, const TriangleMesh& rest, const GridShape& shape) {
  if (name == "hinge")
    return {name, std::make_unique<QuadraticBending>(bending_hinges(rest, 1e-5, 1e-8, 0, "sheet"))};
  SpringMaterial material;
  material.k_stretch = 60.0, material.k_shear = material.k_bend = 3.0;
  material.k_damp_shear = material.k_damp_bend = 1e-3;
  material.compression = name == "buckling" ? Compression::none : Compression::linear;
  if (name == "choi_ko")
    material.bend_model = BendModel::choi_ko, material.k_bend = 1e-4, material.bend_cap = 30.0;
  const ForceClass wanted =
      name == "linear" || name == "buckling" ? ForceClass::shear : ForceClass::bend;
  for (auto& model : grid_springs(shape, rest.positions, material, 0, "sheet"))
    if (model->force_class() == wanted) return {name, std::move(model)};
  return {name, nullptr};
}

class CoreTheorem : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Families, CoreTheorem,
                         testing::Values("linear", "buckling", "linear_bend", "choi_ko", "hinge"),
                         [](const auto& of) { return std::string(of.param); });

TEST_P(CoreTheorem, HoldsInEveryState) {
  GridShape shape{.nu = nu, .nv = nv, .u = 0.05 * Vec3::UnitX(), .v = 0.025 * Vec3::UnitZ()};
  const TriangleMesh rest = make_grid(shape);
  SpringMaterial material;
  material.k_stretch = 600.0;
  const auto stretch = mesh_springs(rest, material, 0, "sheet");
  const Family other = family(GetParam(), rest, shape);
  ASSERT_TRUE(other.outside);
  ASSERT_EQ(stretch[0]->force_class(), ForceClass::stretch);
  const bool is_hinge = other.outside->nodes_per_element() > 2;
  // A spring along a triangle's side would be in the core: of these the core is the diagonal.
  Assembler assembler(nu * nv, {stretch[0].get(), other.outside.get()}, {true, true});
  const std::vector<std::uint8_t> sides = assembler.core_mask(ForceClass::stretch);
  std::vector<std::uint8_t> diagonal(sides.size(), 0);
  for (const Index k : assembler.pattern()->diagonal) diagonal[k] = 1;
  const ElementCore cores[] = {{"stretch", sides, assembler}, {"", diagonal, assembler}};
  ASSERT_EQ(cores[0].leaves_larger_elements_out(), is_hinge);

  Random random(7);
  BlockCsr a(assembler.pattern());
  std::vector<Vec3> x, v, b(rest.positions.size());
  double tightest = 1e300;
  for (int state = 0; state < states; ++state) {
    // Stretched and compressed to twice and half, bent round a cylinder, crumpled a little or all
    // over the place.
    const double stretched = std::pow(2.0, random.uniform()),
                 curvature = state % 3 == 0 ? 0.0 : random.uniform(0.0, 100.0),
                 crumple = 0.025 * std::pow(10.0, random.uniform(-4.0, 0.5)),
                 h = std::pow(10.0, random.uniform(-3.0, -1.3));
    std::vector<double> masses;
    x.clear(), v.clear();
    for (const Vec3& p : rest.positions) {
      Vec3 place = stretched * p;
      if (curvature > 0.0)
        place = {std::sin(curvature * place.x()) / curvature,
                 (1.0 - std::cos(curvature * place.x())) / curvature, place.z()};
      x.push_back(place + crumple * random.direction());
      v.push_back(random.direction());
      masses.push_back(9.5e-6 * std::pow(10.0, random.uniform(-0.5, 0.5)));
    }
    ForceRequest request;
    request.x = x, request.v = v;
    request.matrix_stiffness = h * h, request.matrix_damping = h;
    assembler.assemble(std::vector{request, request}, {masses, 1.0, {}, 0.0}, a, b);
    CoreRest rests[2];
    measure_rests(cores, assembler, a, masses, true, rests);
    const Eigen::MatrixXd all = dense(a);
    for (int c = 0; c < 2; ++c) {
      const Core core = view(cores[c], rests[c]);
      BlockCsr without(assembler.pattern());
      std::vector<Mat3> rest_diagonal(masses.size());
      assembler.gather_core(cores[c].elements(), without);
      assembler.gather_rest_diagonal(cores[c].elements(), rest_diagonal);
      const Eigen::MatrixXd p = dense(without);
      const double q = core.nodes_outside, rho = core.rho;
      ASSERT_GE(rho, 0.0);
      ASSERT_EQ(core.nodes_outside, is_hinge ? 4 : 2);
      const double rounding = 1e-9 * (1.0 + q * rho);
      const auto [least, largest] = spectrum(all, p);
      EXPECT_GE(least, 1.0 - rounding) << state;
      EXPECT_LE(largest, 1.0 + q * rho + rounding) << state;
      EXPECT_LE(largest / least, (1.0 + q * rho) * (1.0 + 1e-8));
      const auto [least_paper, largest_paper] = spectrum(all, with_diagonal(p, rest_diagonal));
      EXPECT_LE(largest_paper, 1.0 + (q - 1.0) * rho / (1.0 + rho) + rounding) << state;
      EXPECT_GE(least_paper, 1.0 / (1.0 + rho) - rounding) << state;
      EXPECT_LE(largest_paper / least_paper, (1.0 + q * rho) * (1.0 + 1e-8));
      EXPECT_GE(core.condition(), 1.0 + q * rho);
      if (rho > 1.0) tightest = std::min(tightest, (1.0 + q * rho) / largest);
    }
  }
  // It is not only true: somewhere it is nearly reached.
  EXPECT_LT(tightest, 3.0);
}

// What the assembler says of a core against its elements one by one.
TEST(CoreElements, AreThoseWithAllBlocksInTheMask) {
  HingedSheet sheet({.nu = 6, .nv = 5});
  Random random(8);
  std::vector<Vec3> x = sheet.rest.positions;
  for (Vec3& place : x) place += 0.004 * random.direction();
  sheet.assemble(x);
  const BlockPattern& p = *sheet.assembler->pattern();
  const auto& hinges = static_cast<const QuadraticBending&>(*sheet.models[1]);
  const auto& springs = static_cast<const SpringModel&>(*sheet.models[0]);
  const double h2 = sheet.material.h * sheet.material.h;
  for (const double share : {0.0, 0.02, 0.3, 1.0}) {
    std::vector<std::uint8_t> mask(static_cast<std::size_t>(p.blocks()), 1);
    for (Index i = 0; i < p.rows(); ++i)
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
        if (p.column[k] < i && random.uniform(0.0, 1.0) < share)
          mask[k] = mask[p.find(p.column[k], i)] = 0;
    const Index n = 3 * sheet.nodes();
    Eigen::MatrixXd inside = sheet.material.node_mass * Eigen::MatrixXd::Identity(n, n),
                    outside = Eigen::MatrixXd::Zero(n, n);
    Index count = 0, largest = 0;
    for (const Spring& s : springs.springs()) {
      const bool is_in = mask[p.find(s.i, s.j)];
      count += is_in;
      if (!is_in) largest = std::max(largest, Index{2});
      const Mat3 block =
          h2 *
          spring_response(springs.law(), s.parameters, x[s.j] - x[s.i], Vec3::Zero()).stiffness;
      for (const Index i : {s.i, s.j})
        for (const Index j : {s.i, s.j})
          (is_in ? inside : outside).block<3, 3>(3 * i, 3 * j) += i == j ? block : Mat3(-block);
    }
    for (const BendingHinge& e : hinges.hinges()) {
      bool is_in = true;
      for (const Index i : e.node)
        for (const Index j : e.node) is_in &= mask[p.find(i, j)] != 0;
      count += is_in;
      if (!is_in) largest = 4;
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
          (is_in ? inside : outside).block<3, 3>(3 * e.node[i], 3 * e.node[j]) +=
              h2 * e.stiffness * e.weight[i] * e.weight[j] * Mat3::Identity();
    }
    const CoreElements core = sheet.assembler->elements_of(mask);
    EXPECT_EQ(core.inside, count);
    EXPECT_EQ(core.nodes_outside, largest);
    BlockCsr without(sheet.assembler->pattern());
    std::vector<Mat3> diagonal(sheet.masses.size());
    sheet.assembler->gather_core(core, without);
    sheet.assembler->gather_rest_diagonal(core, diagonal);
    EXPECT_LT((dense(without) - inside).norm(), 1e-13 * inside.norm());
    for (Index i = 0; i < sheet.nodes(); ++i)
      EXPECT_LT((diagonal[static_cast<std::size_t>(i)] - outside.block<3, 3>(3 * i, 3 * i)).norm(),
                1e-13 * (1e-30 + outside.norm()));
    EXPECT_LT((dense(sheet.a) - inside - outside).norm(), 1e-13 * dense(sheet.a).norm());
  }
}

// ρ from D_R is the one that is read off the blocks of springs, to rounding; both upwards.
TEST(CoreElements, RhoOfSpringsIsThatOfTheirBlocks) {
  Random random(9);
  const GridShape shape{.nu = 40, .nv = 35, .u = Vec3::UnitX(), .v = Vec3::UnitZ()};
  std::vector<Vec3> x = make_grid(shape).positions, v(x.size()), b(x.size());
  const auto models = grid_springs(
      shape, x, {.k_stretch = 600.0, .k_shear = 30.0, .k_bend = 5.0, .k_damp_bend = 1e-3}, 0, "s");
  for (Vec3& place : x) place += 0.01 * random.direction();
  for (Vec3& velocity : v) velocity = random.direction();
  std::vector<double> masses;
  for (std::size_t i = 0; i < x.size(); ++i) masses.push_back(1e-5 * random.uniform(0.5, 2.0));
  Assembler assembler(shape.node_count(), {models[0].get(), models[1].get(), models[2].get()},
                      {true, true, true});
  BlockCsr a(assembler.pattern());
  ForceRequest request;
  request.x = x, request.v = v, request.matrix_stiffness = 1e-4, request.matrix_damping = 1e-2;
  assembler.assemble(std::vector{request, request, request}, {masses, 1.0, {}, 0.0}, a, b);
  for (const ForceClass family : {ForceClass::stretch, ForceClass::shear, ForceClass::bend}) {
    const std::vector<std::uint8_t> mask = assembler.core_mask(family);
    std::vector<Mat3> diagonal(masses.size());
    assembler.gather_rest_diagonal(assembler.elements_of(mask), diagonal);
    const double of_elements = remainder_ratio(diagonal, masses),
                 of_blocks = remainder_ratio(a, mask, masses);
    EXPECT_NEAR(of_elements, of_blocks, 1e-12 * of_blocks);
    double dense_rho = 0.0;
    for (std::size_t i = 0; i < masses.size(); ++i)
      dense_rho = std::max(
          dense_rho, Eigen::SelfAdjointEigenSolver<Mat3>(diagonal[i]).eigenvalues()[2] / masses[i]);
    EXPECT_GE(of_elements, dense_rho);
    EXPECT_LE(of_elements, dense_rho * (1.0 + 1e-6));
    EXPECT_TRUE(may_be_springs(a, mask));
  }
}

TEST(CoreElements, SameBitsForAnyNumberOfThreads) {
  HingedSheet sheet({.nu = 50, .nv = 40});
  Random random(10);
  std::vector<Vec3> x = sheet.rest.positions;
  for (Vec3& place : x) place += 0.004 * random.direction();
  const int usual = thread_count();
  CoreRest first;
  for (const int threads : {1, 2, 3, 4}) {
    set_thread_count(threads);
    sheet.assemble(x);
    const CoreRest rest = sheet.rest_of(sheet.stretch_core());
    if (threads == 1) first = rest;
    EXPECT_TRUE(rest.rho == first.rho && rest.matrix.values == first.matrix.values &&
                rest.rest_diagonal == first.rest_diagonal)
        << threads << " threads";
  }
  set_thread_count(usual);
  EXPECT_GT(first.rho, 0.0);
}

// The blocks of opposite corners have the other sign: without its elements nobody takes such a
// matrix for one of springs.
TEST(CoreElements, HingesAreNotTakenForSprings) {
  const HingedSheet sheet({});
  EXPECT_FALSE(may_be_springs(sheet.a, sheet.assembler->core_mask(ForceClass::stretch)));
  const std::vector<std::uint8_t> all(static_cast<std::size_t>(sheet.a.pattern->blocks()), 1);
  EXPECT_TRUE(may_be_springs(sheet.a, all));
}

}  // namespace
}  // namespace taut::test
