#include "pardiso_factor.h"

#include <fmt/format.h>

#include <cassert>
#include <cstdlib>

#include "taut/base/parallel.h"

namespace taut {

namespace {

static_assert(sizeof(MKL_INT) == sizeof(Index), "the interface layer is LP64");

// PARDISO takes as many threads as Taut's own loops.
class ThreadScope {
 public:
  explicit ThreadScope(const MklRuntime& mkl)
      : mkl_(mkl), before_(mkl.set_num_threads_local(thread_count())) {}
  ~ThreadScope() { mkl_.set_num_threads_local(before_); }
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

 private:
  const MklRuntime& mkl_;
  int before_;
};

std::array<MKL_INT, 64> settings() {
  std::array<MKL_INT, 64> iparm{};
  iparm[0] = 1;    // nothing by default
  iparm[1] = 2;    // METIS nested dissection; its parallel form (3) is not reproducible
  iparm[4] = 2;    // hand out the permutation
  iparm[17] = -1;  // count the factor's nonzeros
  iparm[18] = -1;  // and the factorisation's operations
  iparm[34] = 1;   // indices from 0
  iparm[55] = 1;   // hand out the factor's diagonal
  return iparm;
}

}  // namespace

MKL_INT PardisoFactor::call(MKL_INT phase, double* b, double* x) {
  const MklRuntime& mkl = mkl_runtime();
  const ThreadScope threads(mkl);
  const MKL_INT one = 1, positive_definite = 2, quiet = 0,
                n = static_cast<MKL_INT>(csc_.column_start.size()) - 1;
  MKL_INT error = 0;
  mkl.pardiso(handle_.data(), &one, &one, &positive_definite, &phase, &n, csc_.value.data(),
              csc_.column_start.data(), csc_.row.data(), permutation_.data(), &one, iparm_.data(),
              &quiet, b, x, &error);
  return error;
}

Status PardisoFactor::status_from(MKL_INT error, const char* phase) const {
  switch (error) {
    case 0:
      return {};
    case -2:
      return {Outcome::out_of_memory, fmt::format("PARDISO, {}: not enough memory", phase)};
    case -4:  // iparm[29] counts equations from 1, in the matrix's own order
      return {Outcome::not_positive_definite,
              fmt::format("PARDISO, {}: the matrix is not positive definite (found at unknown {})",
                          phase, iparm_[29] - 1)};
    case -8:
      return {
          Outcome::out_of_memory,
          fmt::format("PARDISO, {}: the factor needs more entries than 32-bit indices can count",
                      phase)};
    default:
      return {Outcome::breakdown, fmt::format("PARDISO, {}: error {}", phase, error)};
  }
}

void PardisoFactor::release() {
  if (holds_memory_) call(-1);
  holds_memory_ = false;
  handle_.fill(nullptr);
  factor_diagonal_.clear();
}

Status PardisoFactor::analyze(const BlockCsr& a) {
  if (!mkl_runtime().error.empty()) return {Outcome::breakdown, mkl_runtime().error};
  release();
  lower_triangle(a, csc_);
  permutation_.resize(static_cast<std::size_t>(a.dofs()));
  iparm_ = settings();
  if (csc_.row.empty()) return {};
  holds_memory_ = true;
  return status_from(call(11), "analysis");
}

Status PardisoFactor::factorize(const BlockCsr& a) {
  lower_triangle(a, csc_);
  assert(static_cast<std::size_t>(a.dofs()) == permutation_.size());
  if (csc_.row.empty()) return {};
  return status_from(call(22), "factorisation");
}

Status PardisoFactor::solve(std::span<const double> b, std::span<double> x) {
  if (b.empty()) return {};
  rhs_.assign(b.begin(), b.end());
  return status_from(call(33, rhs_.data(), x.data()), "solve");
}

Status PardisoFactor::solve_by_cg(const BlockCsr& a, int digits, std::span<const double> b,
                                  std::span<double> x, CgReport& report) {
  report = {};
  lower_triangle(a, csc_);
  if (csc_.row.empty()) return {};
  rhs_.assign(b.begin(), b.end());
  iparm_[3] = 10 * digits + 2;
  const MKL_INT error = call(23, rhs_.data(), x.data());
  iparm_[3] = 0;
  report.iterations = std::abs(iparm_[19]);
  report.factorized = error != 0 || factor_is_new();
  return status_from(error, "solve by CG");
}

// Whether the factor is another than when this was last asked. Intel's reference has a negative
// iparm[19] for CG that failed, but once PARDISO has factorised, it solves by CG with the new
// factor and iparm[19] tells of that. The diagonal of the factor does not hide it.
bool PardisoFactor::factor_is_new() {
  const MKL_INT one = 1;
  MKL_INT error = 0;
  std::vector<double> factor(permutation_.size()), matrix(permutation_.size());
  mkl_runtime().pardiso_getdiag(handle_.data(), factor.data(), matrix.data(), &one, &error);
  if (error == 0 && factor == factor_diagonal_) return false;
  factor_diagonal_ = std::move(factor);
  return true;
}

FactorStatistics PardisoFactor::statistics() const {
  // Memory kept from the analysis on, and that of factorisation and solve, both in units of 1024
  // bytes.
  const double bytes = 1024.0 * (static_cast<double>(iparm_[15]) + static_cast<double>(iparm_[16]));
  return {static_cast<double>(iparm_[17]), 1e6 * static_cast<double>(iparm_[18]), bytes, "metis"};
}

}  // namespace taut
