#pragma once
// A sparse Cholesky factorisation P A Pᵀ = L Lᵀ (or L D Lᵀ), in three steps so that each can be
// kept while the next is redone.
//
//   analyze(A)      ordering and symbolic work; reads the pattern only
//   factorize(A)    numbers; the pattern must be the analysed one (asserted)
//   solve(b, x)     x = A⁻¹ b; b and x may be the same memory
//   permutation()   perm[k] = which unknown of A is k-th in the factor; empty when the backend does
//                   not tell
//   solve_permuted  the same solve for vectors already in the factor's order
//
// Implementations: Taut's own (linalg/block_cholesky.h), Eigen's SimplicialLDLT
// (linalg/eigen_cholesky.h), CHOLMOD (library taut_cholmod, GPL in its supernodal part). They are
// found by name, so that libtaut links no GPL code: a program that wants CHOLMOD calls
// taut::register_cholmod() (taut_cholmod/cholmod.h). One object is used by one thread at a time.

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "taut/base/status.h"
#include "taut/linalg/block_csr.h"
#include "taut/linalg/preconditioner.h"

namespace taut {

struct FactorStatistics {
  double nonzeros = 0.0;  // entries of L
  double flops = 0.0;     // of the factorisation; 0 when the backend does not tell
  double bytes = 0.0;     // memory of the factor
  std::string ordering;   // "amd", "metis", ...
};

class SparseCholesky {
 public:
  virtual ~SparseCholesky() = default;
  virtual std::string name() const = 0;
  virtual Status analyze(const BlockCsr& a) = 0;
  virtual Status factorize(const BlockCsr& a) = 0;
  virtual Status solve(std::span<const double> b, std::span<double> x) = 0;
  virtual std::span<const Index> permutation() const { return {}; }
  virtual Status solve_permuted(std::span<const double> b, std::span<double> x);
  virtual FactorStatistics statistics() const = 0;
};

using CholeskyFactory = std::function<std::unique_ptr<SparseCholesky>()>;

// Makes a backend known under `name`; a later one of the same name replaces the earlier. From any
// thread.
void register_cholesky(const std::string& name, CholeskyFactory factory);
bool has_cholesky(const std::string& name);
// The backend's object, or null when it is not registered. "eigen", "block" and "block_single"
// (Taut's own in double and single precision) are always there.
std::unique_ptr<SparseCholesky> make_cholesky(const std::string& name);
std::vector<std::string> cholesky_names();

// One triangle of A as scalar compressed columns; the arrays are reused between calls.
struct ScalarCsc {
  std::vector<Index> column_start, row;
  std::vector<double> value;
};
// The lower triangle of A (rows >= columns), or, the same arrays read as rows,
// its upper triangle by rows.
void lower_triangle(const BlockCsr& a, ScalarCsc& csc);

}  // namespace taut
