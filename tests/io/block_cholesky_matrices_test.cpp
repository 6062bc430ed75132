// Taut's own factorisation on other people's matrices: scalar blocks, condition numbers up to 1e10.

#include <gtest/gtest.h>

#include "linalg/random_matrix.h"
#include "taut/io/matrix_market.h"
#include "taut/linalg/block_cholesky.h"
#include "test_data.h"

namespace taut::test {
namespace {

TEST(BlockFactorMatrices, ResidualOfForeignSystems) {
  const auto data = data_folder();
  if (!data) GTEST_SKIP() << "no test data: set TAUT_DATA";
  for (const char* name :
       {"1138_bus.mtx", "LFAT5.mtx", "ani1.mtx", "isai_spd.mtx", "bcsstk13.mtx.gz"}) {
    const BlockCsr a = to_system_matrix(read_matrix_market(*data / "matrices" / name), name);
    Random random(1);
    const std::vector<double> b = random.vector(a.dofs());
    std::vector<double> x(b.size()), product(b.size());
    BlockCholesky cholesky;
    ASSERT_TRUE(cholesky.analyze(a).ok());
    const Status status = cholesky.factorize(a);
    ASSERT_TRUE(status.ok()) << name << ": " << status.message;
    cholesky.solve(b, x);
    multiply(a, x, product);
    EXPECT_LT(relative_difference(product, as_eigen(b)), 1e-9) << name;
  }
}

}  // namespace
}  // namespace taut::test
