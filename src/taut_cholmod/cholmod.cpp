#include "taut_cholmod/cholmod.h"

#include <cholmod.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace taut {

namespace {

// Whatever BLAS the system's alternatives give us, if it is OpenBLAS it is told how many threads to
// use.
std::atomic<int> blas_threads = 1;

void tell_blas_its_threads() {
  using SetThreads = void (*)(int);
  if (const auto set_threads =
          reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads")))
    set_threads(blas_threads);
}

// CHOLMOD's supernodal loops ask OpenMP for four threads, however many processors there are, for
// loops of a few hundred numbers: on two processors a factorisation then takes twice as long as on
// one thread. While this lives, OpenMP starts no threads.
class SerialOpenMp {
 public:
  SerialOpenMp() {
    using Get = int (*)();
    const auto get = reinterpret_cast<Get>(dlsym(RTLD_DEFAULT, "omp_get_max_active_levels"));
    set_ = reinterpret_cast<Set>(dlsym(RTLD_DEFAULT, "omp_set_max_active_levels"));
    if (!get || !set_) return;
    before_ = get();
    set_(0);
  }
  ~SerialOpenMp() {
    if (before_ >= 0) set_(before_);
  }
  SerialOpenMp(const SerialOpenMp&) = delete;
  SerialOpenMp& operator=(const SerialOpenMp&) = delete;

 private:
  using Set = void (*)(int);
  Set set_ = nullptr;
  int before_ = -1;
};

Status status_from(const cholmod_common& common, const char* phase) {
  switch (common.status) {
    case CHOLMOD_OK:
    case CHOLMOD_DSMALL:
      return {};
    case CHOLMOD_NOT_POSDEF:
      return {Outcome::not_positive_definite,
              fmt::format("CHOLMOD, {}: the matrix is not positive definite", phase)};
    case CHOLMOD_OUT_OF_MEMORY:
    case CHOLMOD_TOO_LARGE:
      return {Outcome::out_of_memory, fmt::format("CHOLMOD, {}: not enough memory", phase)};
    default:
      return {Outcome::breakdown, fmt::format("CHOLMOD, {}: status {}", phase, common.status)};
  }
}

}  // namespace

struct CholmodCholesky::Implementation {
  cholmod_common common;
  cholmod_factor* factor = nullptr;
  ScalarCsc csc;
  cholmod_dense *solution = nullptr, *workspace_y = nullptr, *workspace_e = nullptr;

  Implementation() {
    cholmod_start(&common);
    common.error_handler = nullptr;
    common.print = 0;
    tell_blas_its_threads();
  }
  ~Implementation() {
    release_factor();
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&workspace_y, &common);
    cholmod_free_dense(&workspace_e, &common);
    cholmod_finish(&common);
  }
  void release_factor() {
    if (factor) cholmod_free_factor(&factor, &common);
  }

  // The first column whose pivot is not positive and finite, or n. CHOLMOD itself stops only at
  // zero pivots of L D Lᵀ, and lets NaN pass.
  std::size_t first_bad_column() const {
    const auto good = [](double pivot) { return pivot > 0.0 && std::isfinite(pivot); };
    const double* x = static_cast<const double*>(factor->x);
    if (!factor->is_super) {
      // the pivot comes first in its column
      const auto* start = static_cast<const Index*>(factor->p);
      for (std::size_t j = 0; j < factor->n; ++j)
        if (!good(x[start[j]])) return j;
      return factor->n;
    }
    const auto *first = static_cast<const Index*>(factor->super),
               *row_start = static_cast<const Index*>(factor->pi),
               *value_start = static_cast<const Index*>(factor->px);
    for (std::size_t s = 0; s < factor->nsuper; ++s) {
      const std::ptrdiff_t rows = row_start[s + 1] - row_start[s];
      for (Index j = first[s]; j < first[s + 1]; ++j)
        if (!good(x[value_start[s] + (j - first[s]) * (rows + 1)]))
          return static_cast<std::size_t>(j);
    }
    return factor->n;
  }

  bool empty() const { return csc.row.empty(); }

  cholmod_sparse view() {
    cholmod_sparse a{};
    a.nrow = a.ncol = csc.column_start.size() - 1;
    a.nzmax = csc.row.size();
    a.p = csc.column_start.data();
    a.i = csc.row.data();
    a.x = csc.value.data();
    a.stype = -1;  // lower triangle
    a.itype = CHOLMOD_INT;
    a.xtype = CHOLMOD_REAL;
    a.dtype = CHOLMOD_DOUBLE;
    a.sorted = 1;
    a.packed = 1;
    return a;
  }

  Status solve(int system, std::span<const double> b, std::span<double> x) {
    if (empty()) return {};
    cholmod_dense rhs{};
    rhs.nrow = rhs.d = rhs.nzmax = b.size();
    rhs.ncol = 1;
    rhs.x = const_cast<double*>(b.data());
    rhs.xtype = CHOLMOD_REAL;
    rhs.dtype = CHOLMOD_DOUBLE;
    if (!cholmod_solve2(system, factor, &rhs, nullptr, &solution, nullptr, &workspace_y,
                        &workspace_e, &common))
      return status_from(common, "solve");
    const double* values = static_cast<const double*>(solution->x);
    std::copy(values, values + x.size(), x.begin());
    return {};
  }
};

CholmodCholesky::CholmodCholesky() : implementation_(std::make_unique<Implementation>()) {}
CholmodCholesky::~CholmodCholesky() = default;

Status CholmodCholesky::analyze(const BlockCsr& a) {
  Implementation& me = *implementation_;
  me.release_factor();
  lower_triangle(a, me.csc);
  if (me.empty()) return {};  // CHOLMOD takes no null pointers, which is what empty arrays have
  cholmod_sparse view = me.view();
  me.factor = cholmod_analyze(&view, &me.common);
  return me.factor ? Status{} : status_from(me.common, "analysis");
}

Status CholmodCholesky::factorize(const BlockCsr& a) {
  Implementation& me = *implementation_;
  lower_triangle(a, me.csc);
  if (me.empty()) return {};
  cholmod_sparse view = me.view();
  const SerialOpenMp serial;
  cholmod_factorize(&view, me.factor, &me.common);
  Status status = status_from(me.common, "factorisation");
  std::size_t bad = me.factor->n;
  if (status.outcome == Outcome::not_positive_definite) {
    bad = std::min(me.factor->minor, me.factor->n - 1);
  } else if (status.ok() && (bad = me.first_bad_column()) < me.factor->n) {
    status = {Outcome::not_positive_definite,
              "CHOLMOD, factorisation: the matrix is not positive definite"};
  }
  if (bad < me.factor->n)
    status.message += fmt::format(" (found at unknown {})", permutation()[bad]);
  return status;
}

Status CholmodCholesky::solve(std::span<const double> b, std::span<double> x) {
  return implementation_->solve(CHOLMOD_A, b, x);
}

Status CholmodCholesky::solve_permuted(std::span<const double> b, std::span<double> x) {
  return implementation_->solve(CHOLMOD_LDLt, b, x);
}

std::span<const Index> CholmodCholesky::permutation() const {
  const cholmod_factor* factor = implementation_->factor;
  if (!factor) return {};
  return {static_cast<const Index*>(factor->Perm), factor->n};
}

FactorStatistics CholmodCholesky::statistics() const {
  const cholmod_common& common = implementation_->common;
  const cholmod_factor* factor = implementation_->factor;
  if (!factor) return {};
  const char* ordering = factor->ordering == CHOLMOD_AMD     ? "amd"
                         : factor->ordering == CHOLMOD_METIS ? "metis"
                                                             : "other";
  const double bytes = factor->is_super ? 8.0 * static_cast<double>(factor->xsize) +
                                              4.0 * static_cast<double>(factor->ssize)
                                        : 12.0 * static_cast<double>(factor->nzmax);
  return {common.lnz, common.fl, bytes, ordering};
}

void register_cholmod() {
  register_cholesky("cholmod", [] { return std::make_unique<CholmodCholesky>(); });
}

void set_cholmod_threads(int count) {
  blas_threads = count;
  tell_blas_its_threads();
}

}  // namespace taut
