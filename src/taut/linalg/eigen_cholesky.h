#pragma once
// Eigen's SimplicialLDLT with approximate minimum degree ordering: the plain baseline, and what
// core_pcg runs on without CHOLMOD.

#include "taut/linalg/sparse_cholesky.h"

namespace taut {

class EigenCholesky : public SparseCholesky {
 public:
  EigenCholesky();
  ~EigenCholesky() override;
  std::string name() const override { return "eigen"; }
  Status analyze(const BlockCsr& a) override;
  Status factorize(const BlockCsr& a) override;
  Status solve(std::span<const double> b, std::span<double> x) override;
  std::span<const Index> permutation() const override { return permutation_; }
  FactorStatistics statistics() const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
  std::vector<Index> permutation_;
};

}  // namespace taut
