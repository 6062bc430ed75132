#pragma once
// PARDISO (Schenk & Gärtner) as Intel oneMKL has it, behind taut::SparseCholesky: the other direct
// solver of the paper. A library of its own, because oneMKL is under Intel's licence: a program
// that links taut_pardiso loads it, libtaut alone does not.
//
// Matrix type 2 (symmetric positive definite), METIS ordering, as many threads as thread_count(),
// the same bits for any number of them. permutation() is what PARDISO hands out. It has no solve
// for vectors already in the factor's order (its forward and backward solves permute by
// themselves), so solve_permuted() permutes, solves and permutes back. Outcomes:
// not_positive_definite (also for NaN) with the unknown, out_of_memory, breakdown with oneMKL's
// error number, or with the reason why oneMKL could not be loaded (by the first analyze).

#include "taut/linalg/sparse_cholesky.h"

namespace taut {

// Makes the backend "pardiso" known to make_cholesky(), and the solver "pardiso_cgs"
// (pardiso_cgs.h) to make_solver(). Once: later calls do nothing.
void register_pardiso();

class PardisoFactor;

class PardisoCholesky : public SparseCholesky {
 public:
  PardisoCholesky();
  ~PardisoCholesky() override;
  PardisoCholesky(const PardisoCholesky&) = delete;
  PardisoCholesky& operator=(const PardisoCholesky&) = delete;

  std::string name() const override { return "pardiso"; }
  Status analyze(const BlockCsr& a) override;
  Status factorize(const BlockCsr& a) override;
  Status solve(std::span<const double> b, std::span<double> x) override;
  std::span<const Index> permutation() const override;
  FactorStatistics statistics() const override;

 private:
  std::unique_ptr<PardisoFactor> factor_;
};

}  // namespace taut
