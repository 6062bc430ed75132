// Solves 4 x = 2 with the strongest factorisation that the installed libraries offer.
#include <cstdio>
#include <span>
#include <vector>

#include "taut/linalg/sparse_cholesky.h"
#ifdef WITH_CHOLMOD
#include "taut_cholmod/cholmod.h"
#endif
#ifdef WITH_PARDISO
#include "taut_pardiso/pardiso.h"
#endif

int main() {
#ifdef WITH_CHOLMOD
  taut::register_cholmod();
#endif
#ifdef WITH_PARDISO
  taut::register_pardiso();
  if (!taut::make_cholesky("pardiso")) return 1;
#endif
  auto cholesky = taut::make_cholesky("cholmod");
  if (!cholesky) cholesky = taut::make_cholesky("eigen");
  taut::BlockCsr a(taut::make_pattern({{0}}, 1));
  a.values[0] = 4.0;
  const std::vector<double> b = {2.0};
  std::vector<double> x(1);
  const bool solved =
      cholesky->analyze(a).ok() && cholesky->factorize(a).ok() && cholesky->solve(b, x).ok();
  std::printf("%s: x = %g\n", cholesky->name().c_str(), solved ? x[0] : 0.0);
}
