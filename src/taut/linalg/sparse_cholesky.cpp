#include "taut/linalg/sparse_cholesky.h"

#include <map>
#include <mutex>
#include <shared_mutex>
#include <utility>

#include "taut/base/parallel.h"
#include "taut/linalg/block_cholesky.h"
#include "taut/linalg/eigen_cholesky.h"

namespace taut {

namespace {

struct Factories {
  std::shared_mutex mutex;
  std::map<std::string, CholeskyFactory> known{
      {"eigen", [] { return std::make_unique<EigenCholesky>(); }},
      {"block",
       [] { return std::make_unique<BlockCholesky>(CholeskyPrecision::double_precision); }},
      {"block_single",
       [] { return std::make_unique<BlockCholesky>(CholeskyPrecision::single_precision); }},
  };
};

Factories& factories() {
  static Factories one;
  return one;
}

CholeskyFactory find_factory(const std::string& name) {
  const std::shared_lock lock(factories().mutex);
  const auto at = factories().known.find(name);
  return at == factories().known.end() ? CholeskyFactory() : at->second;
}

}  // namespace

Status SparseCholesky::solve_permuted(std::span<const double> b, std::span<double> x) {
  const auto perm = permutation();
  if (perm.empty()) return solve(b, x);
  std::vector<double> ordered(b.size());
  for (std::size_t k = 0; k < perm.size(); ++k) ordered[perm[k]] = b[k];
  const Status status = solve(ordered, ordered);
  for (std::size_t k = 0; k < perm.size(); ++k) x[k] = ordered[perm[k]];
  return status;
}

void register_cholesky(const std::string& name, CholeskyFactory factory) {
  const std::unique_lock lock(factories().mutex);
  factories().known[name] = std::move(factory);
}

std::unique_ptr<SparseCholesky> make_cholesky(const std::string& name) {
  const CholeskyFactory make = find_factory(name);
  return make ? make() : nullptr;
}

bool has_cholesky(const std::string& name) { return find_factory(name) != nullptr; }

std::vector<std::string> cholesky_names() {
  const std::shared_lock lock(factories().mutex);
  std::vector<std::string> names;
  for (const auto& [name, factory] : factories().known) names.push_back(name);
  return names;
}

void lower_triangle(const BlockCsr& a, ScalarCsc& csc) {
  // A is symmetric, so the upper triangle row by row is the lower one column by column: each block
  // row becomes dim(i) columns.
  const BlockPattern& p = *a.pattern;
  csc.column_start.resize(static_cast<std::size_t>(p.dofs()) + 1);
  csc.column_start[0] = 0;
  for (Index i = 0; i < p.rows(); ++i) {
    const Index past_diagonal = p.width(i) - p.block_offset[p.diagonal[i]];
    for (Index r = 0; r < p.dim(i); ++r) {
      const Index dof = p.dof_start[i] + r;
      csc.column_start[dof + 1] = csc.column_start[dof] + (p.dim(i) > 0 ? past_diagonal - r : 0);
    }
  }
  csc.row.resize(static_cast<std::size_t>(csc.column_start.back()));
  csc.value.resize(csc.row.size());
  parallel_for(p.rows(), 512, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      for (Index r = 0; r < p.dim(i); ++r) {
        Index out = csc.column_start[p.dof_start[i] + r];
        const double* row = a.values.data() + p.value_start[i] + Offset{r} * p.width(i);
        for (Index k = p.diagonal[i]; k < p.row_start[i + 1]; ++k) {
          const Index j = p.column[k];
          for (Index c = j == i ? r : 0; c < p.dim(j); ++c, ++out) {
            csc.row[out] = p.dof_start[j] + c;
            csc.value[out] = row[p.block_offset[k] + c];
          }
        }
      }
  });
}

}  // namespace taut
