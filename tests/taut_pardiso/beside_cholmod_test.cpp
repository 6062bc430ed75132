// oneMKL in a program that links CHOLMOD: its BLAS, of the same names, must not take the place of
// CHOLMOD's.

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "linalg/random_matrix.h"
#include "taut_cholmod/cholmod.h"
#include "taut_pardiso/pardiso.h"

namespace taut::test {
namespace {

bool solves(SparseCholesky& cholesky, const BlockCsr& a, std::vector<double>& x) {
  return cholesky.analyze(a).ok() && cholesky.factorize(a).ok() && cholesky.solve(x, x).ok();
}

std::string library_of(const char* symbol) {
  Dl_info info{};
  void* address = dlsym(RTLD_DEFAULT, symbol);
  return address && dladdr(address, &info)
             ? std::filesystem::canonical(info.dli_fname).filename().string()
             : "";
}

TEST(PardisoBesideCholmod, EachHasItsOwnBlas) {
  Random random(1);
  const BlockCsr a = random_spd(random, make_pattern(random_graph(random, 200, 6, 150), 3));
  const std::vector<double> b = random.vector(a.dofs());
  std::vector<double> x = b, y = b;
  PardisoCholesky pardiso;
  ASSERT_TRUE(solves(pardiso, a, x));  // oneMKL is loaded now
  for (const char* symbol : {"dgemm_", "dpotrf_", "dsyrk_", "dtrsm_"}) {
    const std::string library = library_of(symbol);
    EXPECT_FALSE(library.empty()) << symbol;
    EXPECT_EQ(library.find("mkl"), std::string::npos) << symbol << " is that of " << library;
  }
  CholmodCholesky cholmod;
  ASSERT_TRUE(solves(cholmod, a, y));
  EXPECT_LT(relative_difference(x, as_eigen(y)), 1e-12);
}

}  // namespace
}  // namespace taut::test
