#pragma once
// CHOLMOD (Chen, Davis, Hager & Rajamanickam 2008) behind taut::SparseCholesky. A library of its
// own, because CHOLMOD's supernodal part is under the GPL: a program that links taut_cholmod is
// bound by that licence, libtaut alone is not.
//
// Its own default strategy chooses the ordering (approximate minimum degree, then METIS nested
// dissection if that fills much) and simplicial or supernodal factorisation. Its BLAS is held to
// one thread, so that results do not depend on the number of threads; benchmarks ask for more.

#include "taut/linalg/sparse_cholesky.h"

namespace taut {

// Makes the backend "cholmod" known to make_cholesky().
void register_cholmod();

// Threads of the BLAS under CHOLMOD, where that is OpenBLAS: those that exist from now on. With
// more than the default, 1, the last bits of a factor depend on their number. OpenBLAS's threads
// wait for work by looking for it, some 20 ms long: what is timed right after CHOLMOD shares its
// processors with them.
void set_cholmod_threads(int count);

class CholmodCholesky : public SparseCholesky {
 public:
  CholmodCholesky();
  ~CholmodCholesky() override;
  CholmodCholesky(const CholmodCholesky&) = delete;
  CholmodCholesky& operator=(const CholmodCholesky&) = delete;

  std::string name() const override { return "cholmod"; }
  Status analyze(const BlockCsr& a) override;
  Status factorize(const BlockCsr& a) override;
  Status solve(std::span<const double> b, std::span<double> x) override;
  std::span<const Index> permutation() const override;
  Status solve_permuted(std::span<const double> b, std::span<double> x) override;
  FactorStatistics statistics() const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace taut
