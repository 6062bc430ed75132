#pragma once
// A preconditioner M_p: an approximation of A whose inverse is cheap to apply. It owns what it
// needs and may outlive the matrix it was built from.
//
//   update(A)     prepares M_p⁻¹ from the values of A. Not ok: M_p is not positive definite or not
//                 finite; says where
//   apply(r, z)   z = M_p⁻¹ r, symmetric positive definite in r where conjugate gradients are to
//                 use it; r and z do not overlap; does not allocate after update
//   remark()      what a user should know about the last update (a shift that was needed), or empty
//
// One object is used by one thread at a time.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "taut/base/status.h"
#include "taut/linalg/block_csr.h"
#include "taut/linalg/near_null_space.h"

namespace taut {

class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  virtual Status update(const BlockCsr& a) = 0;
  virtual void apply(std::span<const double> r, std::span<double> z) const = 0;
  virtual Offset bytes() const { return 0; }
  virtual std::string remark() const { return {}; }
  // How often the last update had to begin anew: for counted work.
  virtual int preparations() const { return 1; }
  // For multigrid: told before update(); others do not need it.
  virtual void set_near_null_space(NearNullSpace) {}
};

// M_p = diag(A): the scalar diagonal (Baraff & Witkin 1998).
class DiagonalPreconditioner : public Preconditioner {
 public:
  Status update(const BlockCsr& a) override;
  void apply(std::span<const double> r, std::span<double> z) const override;
  Offset bytes() const override { return static_cast<Offset>(inverse_.size() * sizeof(double)); }

 private:
  std::vector<double> inverse_;
};

// M_p = the diagonal blocks of A, one per node (Choi & Ko 2002). On the reduced matrix these are
// the blocks projected by the constraints (Boxerman & Ascher 2004).
class BlockDiagonalPreconditioner : public Preconditioner {
 public:
  Status update(const BlockCsr& a) override;
  void apply(std::span<const double> r, std::span<double> z) const override;
  Offset bytes() const override { return static_cast<Offset>(inverse_.size() * sizeof(double)); }

 private:
  std::shared_ptr<const BlockPattern> pattern_;
  // 9 per node, row-major, the leading dim x dim part used with stride dim
  std::vector<double> inverse_;
};

// Inverse of a symmetric positive definite dim x dim block (dim <= 3) with the given row strides.
// False if a pivot is not positive.
bool invert_small(const double* block, Index stride, Index dim, double* inverse);
// What is wrong with the diagonal block of a node that invert_small refused.
Status bad_diagonal_block(const BlockCsr& a, Index node);

}  // namespace taut
