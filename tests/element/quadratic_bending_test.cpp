// Bending over hinges: energy, force and matrix against each other, what must cost nothing, and a
// closed form on a lattice of equilateral triangles.

#include "taut/element/quadratic_bending.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "element/finite_difference.h"
#include "element/random_springs.h"
#include "taut/base/error.h"
#include "taut/element/assembler.h"
#include "taut/mesh/grid.h"

namespace taut {
namespace {

TriangleMesh uneven_sheet(test::Random& random, Index nu, Index nv) {
  TriangleMesh mesh =
      make_grid({.nu = nu, .nv = nv, .u = 0.3 * Vec3::UnitX(), .v = 0.25 * Vec3(0.4, 1, 0)});
  for (Vec3& x : mesh.positions)
    x += 0.2 * 0.3 / nu * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), 0.0);
  return mesh;
}

// Rows of side 1, every second one shifted by half a side.
TriangleMesh equilateral_lattice(Index nu, Index nv) {
  TriangleMesh mesh;
  for (Index j = 0; j < nv; ++j)
    for (Index i = 0; i < nu; ++i)
      mesh.positions.emplace_back(i + 0.5 * (j % 2), 0.5 * std::sqrt(3.0) * j, 0.0);
  for (Index j = 0; j + 1 < nv; ++j)
    for (Index i = 0; i + 1 < nu; ++i) {
      const Index a = j * nu + i, b = a + 1, c = a + nu, d = c + 1;
      if (j % 2 == 0)
        mesh.triangles.push_back({a, b, c}), mesh.triangles.push_back({b, d, c});
      else
        mesh.triangles.push_back({a, d, c}), mesh.triangles.push_back({a, b, d});
    }
  return mesh;
}

TEST(QuadraticBending, ForceIsMinusTheEnergysGradient) {
  test::Random random(1);
  const TriangleMesh mesh = uneven_sheet(random, 4, 3);
  const QuadraticBending model(bending_hinges(mesh, 0.7, 0.0, 0, "sheet"));
  std::vector<Vec3> x = mesh.positions;
  for (Vec3& place : x) place += random.vector(0.1);
  const std::vector<Vec3> v = random.vectors(12, 1.0);
  Assembler assembler(12, {&model}, {true});
  BlockCsr a(assembler.pattern());
  std::vector<Vec3> force(12);
  const std::vector<double> masses(12, 1.0);
  ForceRequest request;
  request.x = x, request.v = v;
  assembler.assemble({&request, 1}, {masses, 0.0, {}, 0.0}, a, force);
  double largest = 0.0;
  for (const Vec3& f : force) largest = std::max(largest, f.norm());
  for (Index i = 0; i < 12; ++i) {
    const Vec3 place = x[static_cast<std::size_t>(i)];
    const Vec3 gradient = test::numeric_gradient(
        [&](const Vec3& moved) {
          std::vector<Vec3> y = x;
          y[static_cast<std::size_t>(i)] = moved;
          return model.energy(y);
        },
        place, 1e-2);
    EXPECT_LT((force[static_cast<std::size_t>(i)] + gradient).norm(), 1e-9 * largest) << i;
  }
}

// The matrix is the force's derivative in any state, what operands are multiplied by, positive
// semidefinite, and its block rows sum to zero.
TEST(QuadraticBending, MatrixIsTheForcesDerivative) {
  test::Random random(2);
  const TriangleMesh mesh = uneven_sheet(random, 4, 3);
  const QuadraticBending model(bending_hinges(mesh, 0.7, 0.2, 0, "sheet"));
  Assembler assembler(12, {&model}, {true});
  BlockCsr a(assembler.pattern());
  const std::vector<double> masses(12, 1.0);
  const std::vector<Vec3> x = random.vectors(12, 0.2), v = random.vectors(12, 1.0),
                          p = random.vectors(12, 1.0), q = random.vectors(12, 1.0);
  const auto assembled = [&](const ForceRequest& request) {
    std::vector<Vec3> b(12);
    assembler.assemble({&request, 1}, {masses, 0.0, {}, 0.0}, a, b);
    Eigen::VectorXd result(36);
    for (Index i = 0; i < 12; ++i) result.segment<3>(3 * i) = b[static_cast<std::size_t>(i)];
    return result;
  };
  const auto dense_matrix = [&](double stiffness, double damping) {
    ForceRequest request;
    request.x = x, request.v = v;
    request.matrix_stiffness = stiffness, request.matrix_damping = damping;
    assembled(request);
    Eigen::MatrixXd dense(36, 36);
    for (Index r = 0; r < 36; ++r)
      for (Index c = 0; c < 36; ++c) dense(r, c) = a.at(r, c);
    return dense;
  };
  const Eigen::MatrixXd k = dense_matrix(1.0, 0.0), d = dense_matrix(0.0, 1.0);
  EXPECT_LT((k - k.transpose()).norm(), 1e-14 * k.norm());
  EXPECT_LT((k - 3.5 * d).norm(), 1e-13 * k.norm());
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly).eigenvalues();
  EXPECT_GT(eigenvalues.minCoeff(), -1e-12 * eigenvalues.maxCoeff());
  for (Index c = 0; c < 3; ++c) {
    Eigen::VectorXd translation = Eigen::VectorXd::Zero(36);
    for (Index i = 0; i < 12; ++i) translation[3 * i + c] = 1.0;
    EXPECT_LT((k * translation).norm(), 1e-13 * k.norm());
  }
  // f is linear, so differences of any size are exact.
  ForceRequest plain, moved, faster;
  plain.x = moved.x = faster.x = x, plain.v = moved.v = faster.v = v;
  std::vector<Vec3> y = x, w = v;
  Eigen::VectorXd dx(36), dv(36), pq(72);
  for (Index i = 0; i < 12; ++i) {
    const std::size_t s = static_cast<std::size_t>(i);
    dx.segment<3>(3 * i) = p[s], dv.segment<3>(3 * i) = q[s];
    y[s] += p[s], w[s] += q[s];
  }
  moved.x = y, faster.v = w;
  const Eigen::VectorXd f = assembled(plain);
  EXPECT_LT((assembled(moved) - f + k * dx).norm(), 1e-12 * k.norm() * dx.norm());
  EXPECT_LT((assembled(faster) - f + d * dv).norm(), 1e-12 * d.norm() * dv.norm());
  ForceRequest operands;
  operands.x = x, operands.v = v, operands.force = 0.0;
  operands.stiffness_operand = p, operands.damping_operand = q;
  EXPECT_LT((assembled(operands) - k * dx - d * dv).norm(), 1e-12 * k.norm() * dx.norm());
}

TEST(QuadraticBending, BoundsItsBlocks) {
  test::Random random(3);
  const TriangleMesh mesh = uneven_sheet(random, 4, 3);
  const QuadraticBending model(bending_hinges(mesh, 0.7, 0.2, 0, "sheet"));
  std::vector<double> blocks(9 * static_cast<std::size_t>(model.block_count())),
      bounds(static_cast<std::size_t>(model.block_count()));
  std::vector<Vec3> vectors(static_cast<std::size_t>(model.vector_count()));
  ForceRequest request;
  request.x = request.v = mesh.positions;
  request.matrix_stiffness = 0.3, request.matrix_damping = 0.4;
  model.evaluate(request, blocks, vectors);
  model.bound_blocks(0.3, 0.4, bounds);
  for (std::size_t b = 0; b < bounds.size(); ++b)
    EXPECT_DOUBLE_EQ(bounds[b], std::abs(blocks[9 * b]));
}

// Flat at rest: stretched, sheared, turned, pressed flat it costs nothing; bent it does.
TEST(QuadraticBending, AffineImagesOfAFlatSheetCostNothing) {
  test::Random random(4);
  const TriangleMesh mesh = uneven_sheet(random, 5, 4);
  const QuadraticBending model(bending_hinges(mesh, 0.7, 0.0, 0, "sheet"));
  for (int trial = 0; trial < 20; ++trial) {
    Mat3 map;
    for (int c = 0; c < 3; ++c) map.col(c) = random.vector(2.0);
    const Vec3 shift = random.vector(5.0);
    std::vector<Vec3> x;
    for (const Vec3& place : mesh.positions) x.push_back(map * place + shift);
    const double flat = model.energy(trial == 0 ? mesh.positions : x);
    for (Vec3& place : x) place.z() += place.x() * place.x();
    EXPECT_GT(model.energy(x), 1e-6);
    EXPECT_LT(flat, 1e-20 * 25.0);
  }
}

// z = ½ (κ_x x² + κ_y y²). Alike in all directions: ½ k_b (κ_x + κ_y)² on a third of both
// triangles of each hinge. Along one direction three times that, on average over a lattice: each
// hinge feels the curvature across its own edge.
TEST(QuadraticBending, EnergyOfACurvedLattice) {
  const TriangleMesh mesh = equilateral_lattice(23, 20);
  const double rigidity = 0.7, kappa = 0.3;
  const std::vector<BendingHinge> hinges = bending_hinges(mesh, rigidity, 0.0, 0, "lattice");
  const QuadraticBending model(hinges);
  const double area = static_cast<double>(hinges.size()) * 2.0 * std::sqrt(3.0) / 4.0 / 3.0;
  const auto energy = [&](double kappa_x, double kappa_y) {
    std::vector<Vec3> x = mesh.positions;
    for (Vec3& p : x) p.z() = 0.5 * (kappa_x * p.x() * p.x() + kappa_y * p.y() * p.y());
    return model.energy(x);
  };
  const double round = 0.5 * rigidity * 4.0 * kappa * kappa * area,
               bent = 0.5 * rigidity * kappa * kappa * area;
  EXPECT_NEAR(energy(kappa, kappa), round, 1e-10 * round);
  EXPECT_NEAR(energy(kappa, 0.0), 3.0 * bent, 0.1 * bent);
  EXPECT_NEAR(energy(0.0, kappa), 3.0 * bent, 0.1 * bent);
  // The opposite corners' block is positive: a spring's would be negative.
  for (const BendingHinge& h : hinges) {
    EXPECT_NEAR(h.weight[2] * h.weight[3], 4.0 / 3.0, 1e-12);
    EXPECT_NEAR(h.weight[0] + h.weight[1] + h.weight[2] + h.weight[3], 0.0, 1e-12);
  }
}

TEST(QuadraticBending, ShiftsNodesAndNamesATriangleWithoutArea) {
  TriangleMesh mesh = make_grid({.nu = 3, .nv = 2});
  const auto shifted = bending_hinges(mesh, 1.0, 0.0, 100, "flag"),
             plain = bending_hinges(mesh, 1.0, 0.0, 0, "flag");
  ASSERT_EQ(plain.size(), 3u);
  for (std::size_t h = 0; h < plain.size(); ++h) {
    EXPECT_EQ(shifted[h].weight, plain[h].weight);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(shifted[h].node[k], plain[h].node[k] + 100);
  }
  mesh.positions[1] = mesh.positions[0];
  try {
    bending_hinges(mesh, 1.0, 0.0, 0, "flag");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("cloth 'flag': triangle 1 has no area"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace taut
