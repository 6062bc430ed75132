#include "taut/contact/impulse_split.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <random>

namespace taut {
namespace {

TEST(SplitImpulse, agreesWithLeastSquares) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  for (int k = 0; k < 1000; ++k) {
    const int count = 1 + k % 3;
    std::vector<Vec3> normals;
    Eigen::Matrix<double, 3, Eigen::Dynamic> n(3, count);
    for (int c = 0; c < count; ++c) {
      normals.push_back(vector().normalized());
      n.col(c) = normals.back();
    }
    if (n.colPivHouseholderQr().matrixR().diagonal().cwiseAbs().minCoeff() < 0.05) continue;
    const Vec3 j = vector();
    std::vector<double> lambda(normals.size());
    const Vec3 tangential = split_impulse(normals, j, lambda);
    const Eigen::VectorXd expected = n.colPivHouseholderQr().solve(j);
    for (int c = 0; c < count; ++c) EXPECT_NEAR(lambda[c], expected[c], 1e-11);
    EXPECT_LT((tangential - (j - n * expected)).norm(), 1e-12);
    EXPECT_LT((tangential_part(normals, j) - tangential).norm(), 1e-13);
  }
}

TEST(SplitImpulse, parallelNormalsCarryItOnce) {
  const std::vector<Vec3> normals = {Vec3::UnitZ(), Vec3::UnitZ(), Vec3(0, 0.6, 0.8),
                                     -Vec3::UnitZ()};
  std::vector<double> lambda(4, 7.0);
  const Vec3 tangential = split_impulse(normals, Vec3(1, 3, 10), lambda);
  EXPECT_NEAR(lambda[0], 6.0, 1e-14);
  EXPECT_EQ(lambda[1], 0.0);
  EXPECT_NEAR(lambda[2], 5.0, 1e-14);
  EXPECT_EQ(lambda[3], 0.0);
  EXPECT_LT((tangential - Vec3(1, 0, 0)).norm(), 1e-14);
}

}  // namespace
}  // namespace taut
