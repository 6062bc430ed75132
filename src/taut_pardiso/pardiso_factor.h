#pragma once
// One PARDISO handle for a symmetric positive definite matrix (mtype 2), its phases as member
// functions. Names iparm[k] are those of Intel's reference.

#include <array>
#include <span>
#include <vector>

#include "mkl_runtime.h"
#include "taut/linalg/sparse_cholesky.h"

namespace taut {

// What PARDISO's conjugate gradients did.
struct CgReport {
  int iterations = 0;       // iparm[19]
  bool factorized = false;  // the factor is a new one
};

class PardisoFactor {
 public:
  PardisoFactor() = default;
  ~PardisoFactor() { release(); }
  PardisoFactor(const PardisoFactor&) = delete;
  PardisoFactor& operator=(const PardisoFactor&) = delete;

  Status analyze(const BlockCsr& a);    // phase 11
  Status factorize(const BlockCsr& a);  // phase 22
  // Phase 33. b and x may be the same memory.
  Status solve(std::span<const double> b, std::span<double> x);
  // Phase 23 with iparm[3] = 10 digits + 2: solves a x = b by CG, to 10^-digits, with the factor
  // that the last call of this function left. Where there is none since analyze(), or CG fails,
  // PARDISO factorises `a`, solves with that, and keeps it.
  Status solve_by_cg(const BlockCsr& a, int digits, std::span<const double> b, std::span<double> x,
                     CgReport& report);

  std::span<const Index> permutation() const { return permutation_; }
  FactorStatistics statistics() const;

 private:
  MKL_INT call(MKL_INT phase, double* b = nullptr, double* x = nullptr);
  Status status_from(MKL_INT error, const char* phase) const;
  bool factor_is_new();
  void release();

  std::array<void*, 64> handle_{};
  std::array<MKL_INT, 64> iparm_{};
  bool holds_memory_ = false;
  ScalarCsc csc_;
  std::vector<Index> permutation_;
  std::vector<double> rhs_, factor_diagonal_;
};

}  // namespace taut
