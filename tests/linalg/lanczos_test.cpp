// The extreme eigenvalues from CG's coefficients against dense generalised eigenvalues.

#include "taut/linalg/lanczos.h"

#include <gtest/gtest.h>

#include "linalg/random_matrix.h"
#include "taut/linalg/factor_preconditioner.h"
#include "taut/linalg/pcg.h"

namespace taut::test {
namespace {

BlockCsr mixed_spd(Random& random, double margin) {
  const auto dims = random_dims(random, 60);
  return random_spd(random, make_pattern(random_graph(random, 60, 3, 20), dims), margin);
}

CgCoefficients run(const BlockCsr& a, const Preconditioner& m, Random& random, double tolerance,
                   int max_iterations = 1000) {
  const std::vector<double> b = random.vector(a.dofs());
  std::vector<double> x(b.size(), 0.0);
  CgCoefficients coefficients;
  const KrylovResult result =
      pcg(BlockCsrOperator(a), m, b, x, {tolerance, max_iterations, {}, &coefficients});
  EXPECT_EQ(std::ssize(coefficients.alpha), result.iterations);
  EXPECT_EQ(std::ssize(coefficients.beta), result.iterations);
  return coefficients;
}

// A a = λ P a
SpectrumEnds dense_ends(const BlockCsr& a, const Eigen::MatrixXd& p) {
  const Eigen::VectorXd lambda = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(
                                     dense(a), p, Eigen::EigenvaluesOnly | Eigen::Ax_lBx)
                                     .eigenvalues();
  return {lambda.minCoeff(), lambda.maxCoeff()};
}

TEST(Lanczos, FindsTheEndsOfTheSpectrumUnderADiagonal) {
  Random random(11);
  for (const double margin : {1.0, 1e-2, 1e-4}) {
    const BlockCsr a = mixed_spd(random, margin);
    DiagonalPreconditioner m;
    ASSERT_TRUE(m.update(a).ok());
    const SpectrumEnds found = spectrum_ends(run(a, m, random, 1e-30));
    const SpectrumEnds expected = dense_ends(a, Eigen::MatrixXd(dense(a).diagonal().asDiagonal()));
    EXPECT_NEAR(found.smallest, expected.smallest, 1e-4 * expected.smallest) << margin;
    EXPECT_NEAR(found.largest, expected.largest, 1e-4 * expected.largest) << margin;
  }
}

TEST(Lanczos, FindsTheEndsOfTheSpectrumUnderAFactor) {
  Random random(12);
  const BlockCsr a = mixed_spd(random, 1e-3);
  BlockCsr p = a;
  for_each_entry(
      p, [](Index r, Index c, double& value) { value = r == c ? 1.5 * value : 0.7 * value; });
  const auto factor = make_cholesky("eigen");
  ASSERT_TRUE(factor->analyze(p).ok() && factor->factorize(p).ok());
  const SpectrumEnds found =
      spectrum_ends(run(a, FactorPreconditioner(*factor, false), random, 1e-30));
  const SpectrumEnds expected = dense_ends(a, dense(p));
  EXPECT_NEAR(found.smallest, expected.smallest, 1e-4 * expected.smallest);
  EXPECT_NEAR(found.largest, expected.largest, 1e-4 * expected.largest);
}

// Ritz values: within the spectrum from the first iteration on, and wider with each.
TEST(Lanczos, ApproachesFromWithin) {
  Random random(13);
  const BlockCsr a = mixed_spd(random, 1e-3);
  DiagonalPreconditioner m;
  ASSERT_TRUE(m.update(a).ok());
  const SpectrumEnds expected = dense_ends(a, Eigen::MatrixXd(dense(a).diagonal().asDiagonal()));
  SpectrumEnds before{1e300, 0.0};
  for (const int iterations : {1, 3, 6, 12}) {
    Random same(14);
    const SpectrumEnds found = spectrum_ends(run(a, m, same, 1e-30, iterations));
    EXPECT_LT(found.smallest, before.smallest);
    EXPECT_GT(found.largest, before.largest);
    EXPECT_GE(found.smallest, expected.smallest * (1.0 - 1e-9));
    EXPECT_LE(found.largest, expected.largest * (1.0 + 1e-9));
    before = found;
  }
}

TEST(Lanczos, NothingFromNothing) {
  EXPECT_EQ(spectrum_ends({}).smallest, 0.0);
  EXPECT_EQ(spectrum_ends({}).largest, 0.0);
}

}  // namespace
}  // namespace taut::test
