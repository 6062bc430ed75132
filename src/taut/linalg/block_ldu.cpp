#include "taut/linalg/block_ldu.h"

#include <cassert>

#include "taut/base/simd.h"

namespace taut {

namespace {

struct Sweep {
  Index places;
  const Index* dof;
  const Index* dim;
  const Index* start;
  const Index* column;
  const double* blocks;
};

// w = L⁻¹ r, v = D⁻¹ w.
TAUT_MULTIVERSION void forward_3(const Sweep& s, const double* inverse_diagonal, const double* r,
                                 double* w, double* v) {
  for (Index p = 0; p < s.places; ++p) {
    const double* from = r + s.dof[p];
    const Index dim = s.dim[p];
    double a = from[0], b = dim > 1 ? from[1] : 0.0, c = dim > 2 ? from[2] : 0.0;
    for (Index k = s.start[p]; k < s.start[p + 1]; ++k) {
      const double* l = s.blocks + 9 * static_cast<std::ptrdiff_t>(k);
      const double* x = w + 3 * static_cast<std::ptrdiff_t>(s.column[k]);
      a -= l[0] * x[0] + l[1] * x[1] + l[2] * x[2];
      b -= l[3] * x[0] + l[4] * x[1] + l[5] * x[2];
      c -= l[6] * x[0] + l[7] * x[1] + l[8] * x[2];
    }
    const std::ptrdiff_t at = 3 * static_cast<std::ptrdiff_t>(p);
    w[at] = a, w[at + 1] = b, w[at + 2] = c;
    const double* d = inverse_diagonal + 3 * at;
    v[at] = d[0] * a + d[1] * b + d[2] * c;
    v[at + 1] = d[3] * a + d[4] * b + d[5] * c;
    v[at + 2] = d[6] * a + d[7] * b + d[8] * c;
  }
}

void put(const Sweep& s, Index p, double a, double b, double c, double* z) {
  double* to = z + s.dof[p];
  to[0] = a;
  if (s.dim[p] > 1) to[1] = b;
  if (s.dim[p] > 2) to[2] = c;
}

// z = L⁻ᵀ v; v is used up.
TAUT_MULTIVERSION void backward_transposed_3(const Sweep& s, double* v, double* z) {
  for (Index p = s.places - 1; p >= 0; --p) {
    const double* own = v + 3 * static_cast<std::ptrdiff_t>(p);
    const double a = own[0], b = own[1], c = own[2];
    put(s, p, a, b, c, z);
    for (Index k = s.start[p]; k < s.start[p + 1]; ++k) {
      const double* l = s.blocks + 9 * static_cast<std::ptrdiff_t>(k);
      double* x = v + 3 * static_cast<std::ptrdiff_t>(s.column[k]);
      x[0] -= l[0] * a + l[3] * b + l[6] * c;
      x[1] -= l[1] * a + l[4] * b + l[7] * c;
      x[2] -= l[2] * a + l[5] * b + l[8] * c;
    }
  }
}

// z = U⁻¹ v; v becomes z in level order.
TAUT_MULTIVERSION void backward_3(const Sweep& s, double* v, double* z) {
  for (Index p = s.places - 1; p >= 0; --p) {
    double* own = v + 3 * static_cast<std::ptrdiff_t>(p);
    double a = own[0], b = own[1], c = own[2];
    for (Index k = s.start[p]; k < s.start[p + 1]; ++k) {
      const double* u = s.blocks + 9 * static_cast<std::ptrdiff_t>(k);
      const double* x = v + 3 * static_cast<std::ptrdiff_t>(s.column[k]);
      a -= u[0] * x[0] + u[1] * x[1] + u[2] * x[2];
      b -= u[3] * x[0] + u[4] * x[1] + u[5] * x[2];
      c -= u[6] * x[0] + u[7] * x[1] + u[8] * x[2];
    }
    own[0] = a, own[1] = b, own[2] = c;
    put(s, p, a, b, c, z);
  }
}

void forward_1(const Sweep& s, const double* inverse_diagonal, const double* r, double* w,
               double* v) {
  for (Index p = 0; p < s.places; ++p) {
    double a = r[s.dof[p]];
    for (Index k = s.start[p]; k < s.start[p + 1]; ++k) a -= s.blocks[k] * w[s.column[k]];
    w[p] = a;
    v[p] = inverse_diagonal[p] * a;
  }
}

void backward_transposed_1(const Sweep& s, double* v, double* z) {
  for (Index p = s.places - 1; p >= 0; --p) {
    const double a = z[s.dof[p]] = v[p];
    for (Index k = s.start[p]; k < s.start[p + 1]; ++k) v[s.column[k]] -= s.blocks[k] * a;
  }
}

void backward_1(const Sweep& s, double* v, double* z) {
  for (Index p = s.places - 1; p >= 0; --p) {
    double a = v[p];
    for (Index k = s.start[p]; k < s.start[p + 1]; ++k) a -= s.blocks[k] * v[s.column[k]];
    z[s.dof[p]] = v[p] = a;
  }
}

}  // namespace

void BlockLdu::set_pattern(const std::shared_ptr<const BlockPattern>& pattern, bool symmetric) {
  if (layout_.pattern != pattern) layout_ = triangular_layout(pattern, !symmetric);
  const std::size_t size = static_cast<std::size_t>(block_size()),
                    vector_size = static_cast<std::size_t>(layout_.places() * layout_.block);
  lower_.resize(layout_.lower.column.size() * size);
  upper_.resize(layout_.upper.column.size() * size);
  inverse_diagonal_.resize(layout_.node.size() * size);
  w_.resize(vector_size), v_.resize(vector_size);
}

void BlockLdu::solve(std::span<const double> r, std::span<double> z) const {
  assert(static_cast<Index>(r.size()) == layout_.pattern->dofs() && r.size() == z.size());
  const auto sweep = [&](const TriangularRows& rows, const std::vector<double>& blocks) {
    return Sweep{layout_.places(),  layout_.dof.data(), layout_.dim.data(),
                 rows.start.data(), rows.column.data(), blocks.data()};
  };
  const Sweep lower = sweep(layout_.lower, lower_), upper = sweep(layout_.upper, upper_);
  const bool symmetric = layout_.upper.start.empty(), scalar = layout_.block == 1;
  scalar ? forward_1(lower, inverse_diagonal_.data(), r.data(), w_.data(), v_.data())
         : forward_3(lower, inverse_diagonal_.data(), r.data(), w_.data(), v_.data());
  if (symmetric)
    scalar ? backward_transposed_1(lower, v_.data(), z.data())
           : backward_transposed_3(lower, v_.data(), z.data());
  else
    scalar ? backward_1(upper, v_.data(), z.data()) : backward_3(upper, v_.data(), z.data());
}

Offset BlockLdu::bytes() const {
  return layout_.bytes() + static_cast<Offset>((lower_.size() + upper_.size() +
                                                inverse_diagonal_.size() + w_.size() + v_.size()) *
                                               sizeof(double));
}

}  // namespace taut
