#include "taut_pardiso/pardiso.h"

#include "pardiso_factor.h"
#include "taut/solve/solver_registry.h"
#include "taut_pardiso/pardiso_cgs.h"

namespace taut {

PardisoCholesky::PardisoCholesky() : factor_(std::make_unique<PardisoFactor>()) {}
PardisoCholesky::~PardisoCholesky() = default;

Status PardisoCholesky::analyze(const BlockCsr& a) { return factor_->analyze(a); }
Status PardisoCholesky::factorize(const BlockCsr& a) { return factor_->factorize(a); }
Status PardisoCholesky::solve(std::span<const double> b, std::span<double> x) {
  return factor_->solve(b, x);
}
std::span<const Index> PardisoCholesky::permutation() const { return factor_->permutation(); }
FactorStatistics PardisoCholesky::statistics() const { return factor_->statistics(); }

void register_pardiso() {
  static const bool once = [] {
    register_cholesky("pardiso", [] { return std::make_unique<PardisoCholesky>(); });
    register_solver(
        "pardiso_cgs",
        [](const SolverOptions& options) { return std::make_unique<PardisoCgs>(options); },
        {.shows_iterates = false, .needs_backend = "pardiso"});
    return true;
  }();
  static_cast<void>(once);
}

}  // namespace taut
