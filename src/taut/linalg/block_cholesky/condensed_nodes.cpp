// NumericFactor's condensed nodes (condensation.h). Gathered blocks begin at multiples of nine;
// what is read as the fourth number of a block's row is the next row's first one; in the solves,
// when nobody writes, also the next block's.

#include <algorithm>
#include <cmath>
#include <limits>

#include "taut/base/simd.h"
#include "taut/linalg/block_cholesky/numeric_factor.h"
#include "taut/linalg/block_cholesky/quad.h"

namespace taut {

namespace {

constexpr Index none_is_bad = std::numeric_limits<Index>::max();

bool is_good(double pivot) { return pivot > 0.0 && std::isfinite(pivot); }

// M = L⁻¹ for C = L Lᵀ, of the lower triangle of a block of `dim` rows; beyond, zero.
struct InverseFactor {
  double m[3][3] = {};
  Index bad = -1;  // the first bad pivot, if any
  double bad_value = 0.0;

  InverseFactor(const double (&c)[3][3], Index dim) {
    double l[3][3] = {};
    for (Index j = 0; j < dim; ++j) {
      double pivot = c[j][j];
      for (Index k = 0; k < j; ++k) pivot -= l[j][k] * l[j][k];
      if (!is_good(pivot)) {
        bad = j, bad_value = pivot;
        return;
      }
      m[j][j] = 1.0 / std::sqrt(pivot);
      for (Index i = j + 1; i < dim; ++i) {
        double entry = c[i][j];
        for (Index k = 0; k < j; ++k) entry -= l[i][k] * l[j][k];
        l[i][j] = entry * m[j][j];
      }
      for (Index i = 0; i < j; ++i) {
        double sum = 0.0;
        for (Index k = i; k < j; ++k) sum += l[j][k] * m[k][i];
        m[j][i] = -sum * m[j][j];
      }
    }
  }
};

// The same for three rows, straight on.
template <class T>
TAUT_ALWAYS_INLINE bool invert_plain(const T* c, double (&m)[6]) {
  const double p0 = c[0], r0 = 1.0 / __builtin_sqrt(p0);
  const double l10 = c[3] * r0, l20 = c[6] * r0;
  const double p1 = c[4] - l10 * l10, r1 = 1.0 / __builtin_sqrt(p1);
  const double l21 = (c[7] - l20 * l10) * r1;
  const double p2 = c[8] - l20 * l20 - l21 * l21, r2 = 1.0 / __builtin_sqrt(p2);
  const double m10 = -l10 * r0 * r1;
  m[0] = r0, m[1] = m10, m[2] = r1, m[3] = -(l20 * r0 + l21 * m10) * r2, m[4] = -l21 * r1 * r2,
  m[5] = r2;
  constexpr double most = std::numeric_limits<double>::max();
  return p0 > 0.0 && p1 > 0.0 && p2 > 0.0 && p0 <= most && p1 <= most && p2 <= most;
}

// B := M B, M lower triangular; the fourth number of its last row stays.
template <class T>
TAUT_ALWAYS_INLINE void multiply_lower(const T (&m)[6], T* block) {
  using Four = typename Quad<T>::Type;
  const Four b0 = quad(block), b1 = quad(block + 3);
  Four b2;
  get_last_row(block, b2);
  const Four last = m[3] * b0 + m[4] * b1 + m[5] * b2;
  quad(block) = m[0] * b0;
  quad(block + 3) = m[1] * b0 + m[2] * b1;
  put_three(last, block + 6);
}

// C and the B_ij become G and the U_ij.
template <class T>
TAUT_ALWAYS_INLINE bool condense_plain(T* block, Index blocks) {
  double inverse[6];
  if (!invert_plain(block, inverse)) return false;
  T m[6];
  for (Index k = 0; k < 6; ++k) m[k] = static_cast<T>(inverse[k]);
  for (Index e = 1; e < blocks; ++e) multiply_lower(m, block + Offset{9} * e);
  for (Index i = 0; i < 3; ++i)
    for (Index r = 0; r < 3; ++r) block[3 * i + r] = i > r ? T(0) : m[r * (r + 1) / 2 + i];
  return true;
}

// Of those of A's rows begin ... end-1 whose nodes are condensed and plain; the place of the first
// one with a bad pivot.
template <class T>
TAUT_ALWAYS_INLINE Index condense_plain_rows(const FactorLayout& layout,
                                             const std::uint8_t* is_plain, Index begin, Index end,
                                             T* gathered) {
  const Index* place = layout.place.data();
  const Index* start = layout.block_start.data();
  Index bad = none_is_bad;
  for (Index i = begin; i < end; ++i) {
    const Index k = place[i];
    if (k < 0 || k >= layout.condensed || !is_plain[k]) continue;
    if (!condense_plain(gathered + Offset{9} * start[k], start[k + 1] - start[k]))
      bad = std::min(bad, k);
  }
  return bad;
}

TAUT_MULTIVERSION Index condense_some(const FactorLayout& layout, const std::uint8_t* is_plain,
                                      Index begin, Index end, float* gathered) {
  return condense_plain_rows(layout, is_plain, begin, end, gathered);
}
TAUT_MULTIVERSION Index condense_some(const FactorLayout& layout, const std::uint8_t* is_plain,
                                      Index begin, Index end, double* gathered) {
  return condense_plain_rows(layout, is_plain, begin, end, gathered);
}

// What the solves of condensed nodes without a basis read, and whose neighbours have none either.
template <class T>
struct PlainNodes {
  // row, unknown: FactorLayout::condensed_row, FactorVectors::start
  const Index *block_start, *row, *unknown;
  const T* gathered;
  double scale;
};

// y_i = Gᵀ_i b_i, and -Σ Uᵀ_ij y_i to the front's vector y.
template <class T>
TAUT_ALWAYS_INLINE void forward_plain(const PlainNodes<T>& nodes, Index k, const double* b, T* own,
                                      T* y) {
  using Four = typename Quad<T>::Type;
  const T* block = nodes.gathered + Offset{9} * nodes.block_start[k];
  const double* from = b + nodes.unknown[k];
  T load[3];
  for (Index j = 0; j < 3; ++j) load[j] = static_cast<T>(nodes.scale * from[j]);
  const Four yk = load[0] * quad(block) + load[1] * quad(block + 3) + load[2] * quad(block + 6);
  quad(own + Offset{4} * k) = yk;
  for (Index e = nodes.block_start[k] + 1; e < nodes.block_start[k + 1]; ++e) {
    block += 9;
    const Four sum = yk[0] * quad(block) + yk[1] * quad(block + 3) + yk[2] * quad(block + 6);
    // Number by number: the next node may begin three further, and four would
    // have to wait for each other.
    for (Index r = 0; r < 3; ++r) y[nodes.row[e] + r] -= sum[r];
  }
}

// x_i = beta x_i + G_i (y_i - Σ_j U_ij x_j), x_j in the front's vector y. Sums have four parts, and
// the fourth is nobody's.
template <class T>
TAUT_ALWAYS_INLINE void backward_plain(const PlainNodes<T>& nodes, Index k, const T* own,
                                       const T* y, double beta, double* x) {
  using Four = typename Quad<T>::Type;
  const T* const g = nodes.gathered + Offset{9} * nodes.block_start[k];
  const T* block = g;
  Four sum[3] = {};
  for (Index e = nodes.block_start[k] + 1; e < nodes.block_start[k + 1]; ++e) {
    block += 9;
    const Four z = quad(y + nodes.row[e]);
    for (Index r = 0; r < 3; ++r) sum[r] += quad(block + 3 * r) * z;
  }
  T rest[3];
  for (Index r = 0; r < 3; ++r)
    rest[r] = own[Offset{4} * k + r] - ((sum[r][0] + sum[r][1]) + sum[r][2]);
  double* to = x + nodes.unknown[k];
  for (Index i = 0; i < 3; ++i) {
    const double value =
        nodes.scale *
        static_cast<double>(g[3 * i] * rest[0] + g[3 * i + 1] * rest[1] + g[3 * i + 2] * rest[2]);
    to[i] = beta == 0.0 ? value : value + beta * to[i];
  }
}

template <class T>
TAUT_ALWAYS_INLINE void forward_run(const PlainNodes<T>& nodes, const std::uint8_t* is_plain,
                                    Index begin, Index end, const double* b, T* own, T* y) {
  for (Index k = begin; k < end; ++k)
    if (is_plain[k]) forward_plain(nodes, k, b, own, y);
}
template <class T>
TAUT_ALWAYS_INLINE void backward_run(const PlainNodes<T>& nodes, const std::uint8_t* is_plain,
                                     Index begin, Index end, const T* own, const T* y, double beta,
                                     double* x) {
  for (Index k = begin; k < end; ++k)
    if (is_plain[k]) backward_plain(nodes, k, own, y, beta, x);
}

#define TAUT_SOLVE_SOME(T)                                                                       \
  TAUT_MULTIVERSION void forward_some(const PlainNodes<T>& nodes, const std::uint8_t* is_plain,  \
                                      Index begin, Index end, const double* b, T* own, T* y) {   \
    forward_run(nodes, is_plain, begin, end, b, own, y);                                         \
  }                                                                                              \
  TAUT_MULTIVERSION void backward_some(const PlainNodes<T>& nodes, const std::uint8_t* is_plain, \
                                       Index begin, Index end, const T* own, const T* y,         \
                                       double beta, double* x) {                                 \
    backward_run(nodes, is_plain, begin, end, own, y, beta, x);                                  \
  }
TAUT_SOLVE_SOME(float)
TAUT_SOLVE_SOME(double)
#undef TAUT_SOLVE_SOME

}  // namespace

// What is_plain_with_neighbours_ says of the node at place k, or of the condensed nodes beside it.
template <class T>
void NumericFactor<T>::mark_projected(Index k) {
  if (k < layout_.condensed) {
    is_plain_with_neighbours_[k] = 0;
    return;
  }
  const Index diagonal = layout_.block_start[k];
  for (Index p = layout_.pair_start[diagonal]; p < layout_.pair_start[diagonal + 1]; ++p) {
    Index e = layout_.pair[p].first;
    // to the condensed node's own block, its first
    while (layout_.block[e].place >= layout_.condensed) --e;
    is_plain_with_neighbours_[layout_.block[e].place] = 0;
  }
}

template <class T>
void NumericFactor<T>::condense_rows(Index begin, Index end) {
  Index bad = condense_some(layout_, is_plain_.data(), begin, end, gathered_.data());
  for (Index i = begin; i < end; ++i)
    if (const Index k = layout_.place[i];
        k >= 0 && k < layout_.condensed && !is_plain_[k] && condense_projected(k).column >= 0)
      bad = std::min(bad, k);
  Index first = first_bad_condensed_.load(std::memory_order_relaxed);
  while (bad < first &&
         !first_bad_condensed_.compare_exchange_weak(first, bad, std::memory_order_relaxed)) {
  }
}

// A node of any number of unknowns; its blocks stay what they are where a pivot is bad.
template <class T>
BadPivot NumericFactor<T>::condense_projected(Index k) {
  T* block = gathered_.data() + layout_.gathered_start[k];
  const Mat3 q = basis_of_[k] >= 0 ? basis_[basis_of_[k]] : Mat3(Mat3::Identity());
  Mat3 c;
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 3; ++j)
      c(i, j) = static_cast<double>(block[3 * std::max(i, j) + std::min(i, j)]);
  const Mat3 projected = q.transpose() * c * q;
  double lower[3][3];
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 3; ++j) lower[i][j] = projected(i, j);
  const InverseFactor inverse(lower, dim_[k]);
  if (inverse.bad >= 0) return {inverse.bad, inverse.bad_value};

  // In the basis: Q itself is applied in double precision, so that nothing comes out in directions
  // that the node has not.
  Mat3 g;
  for (Index i = 0; i < 3; ++i)
    for (Index r = 0; r < 3; ++r) g(i, r) = inverse.m[r][i];
  const auto put = [](const Mat3& from, T* to) {
    for (Index i = 0; i < 3; ++i)
      for (Index j = 0; j < 3; ++j) to[3 * i + j] = static_cast<T>(from(i, j));
  };
  for (Index e = 1; e < layout_.block_start[k + 1] - layout_.block_start[k]; ++e) {
    Mat3 b;
    for (Index i = 0; i < 9; ++i) b(i / 3, i % 3) = static_cast<double>(block[Offset{9} * e + i]);
    put(g.transpose() * (q.transpose() * b), block + Offset{9} * e);
  }
  put(g, block);
  return {};
}

// Returns the sum of yᵀ_i y_i.
template <class T>
double NumericFactor<T>::forward_condensed(const Front& front, const FactorVectors& vectors,
                                           const double* b, int slot) {
  T *own = condensed_vectors_[slot].data(), *y = vectors_[slot].data() + front.vector;
  const PlainNodes<T> plain{layout_.block_start.data(), layout_.condensed_row.data(),
                            vectors.start.data(), gathered_.data(), vectors.scale};
  forward_some(plain, is_plain_with_neighbours_.data(), front.first_condensed, front.last_condensed,
               b, own, y);
  double norm2 = 0.0;
  for (Index k = front.first_condensed; k < front.last_condensed; ++k) {
    const T* yk = own + Offset{4} * k;
    if (!is_plain_with_neighbours_[k])
      forward_projected(k, vectors.scale, b + vectors.start[k], own + Offset{4} * k, y);
    norm2 += static_cast<double>((yk[0] * yk[0] + yk[1] * yk[1]) + yk[2] * yk[2]);
  }
  return norm2;
}

template <class T>
void NumericFactor<T>::forward_projected(Index k, double scale, const double* b, T* own,
                                         T* y) const {
  const T* block = gathered_.data() + Offset{9} * layout_.block_start[k];
  std::fill(own, own + 3, T(0));
  for (Index j = 0; j < dim_[k]; ++j) {
    const T load = static_cast<T>(
        scale *
        (basis_of_[k] < 0 ? b[j] : basis_[basis_of_[k]].col(j).dot(Eigen::Map<const Vec3>(b))));
    for (Index r = 0; r < 3; ++r) own[r] += load * block[3 * j + r];
  }
  for (Index e = layout_.block_start[k] + 1; e < layout_.block_start[k + 1]; ++e) {
    block += 9;
    const Index other = layout_.block[e].place;
    T* to = y + layout_.condensed_row[e];
    Vec3 sum;
    for (Index i = 0; i < 3; ++i)
      sum[i] =
          static_cast<double>(own[0] * block[i] + own[1] * block[3 + i] + own[2] * block[6 + i]);
    for (Index r = 0; r < dim_[other]; ++r)
      to[r] -=
          static_cast<T>(basis_of_[other] < 0 ? sum[r] : basis_[basis_of_[other]].col(r).dot(sum));
  }
}

template <class T>
void NumericFactor<T>::backward_condensed(const Front& front, const FactorVectors& vectors,
                                          double beta, double* x) const {
  const T *own = condensed_vectors_[0].data(), *y = vectors_[0].data() + front.vector;
  const double scale = 1.0 / vectors.scale;
  const PlainNodes<T> plain{layout_.block_start.data(), layout_.condensed_row.data(),
                            vectors.start.data(), gathered_.data(), scale};
  backward_some(plain, is_plain_with_neighbours_.data(), front.first_condensed,
                front.last_condensed, own, y, beta, x);
  for (Index k = front.first_condensed; k < front.last_condensed; ++k) {
    if (is_plain_with_neighbours_[k]) continue;
    const Vec3 solution = backward_projected(k, own + Offset{4} * k, y);
    double* to = x + vectors.start[k];
    for (Index i = 0; i < (basis_of_[k] >= 0 ? 3 : dim_[k]); ++i) {
      const double value = scale * solution[i];
      to[i] = beta == 0.0 ? value : value + beta * to[i];
    }
  }
}

template <class T>
Vec3 NumericFactor<T>::backward_projected(Index k, const T* own, const T* y) const {
  const T* const g = gathered_.data() + Offset{9} * layout_.block_start[k];
  const T* block = g;
  T rest[3] = {own[0], own[1], own[2]};
  for (Index e = layout_.block_start[k] + 1; e < layout_.block_start[k + 1]; ++e) {
    block += 9;
    T z[3];
    turn_back(layout_.block[e].place, y + layout_.condensed_row[e], z);
    for (Index r = 0; r < 3; ++r)
      rest[r] -= block[3 * r] * z[0] + block[3 * r + 1] * z[1] + block[3 * r + 2] * z[2];
  }
  Vec3 solution = Vec3::Zero();
  for (Index i = 0; i < dim_[k]; ++i) {
    const double entry =
        static_cast<double>(g[3 * i] * rest[0] + g[3 * i + 1] * rest[1] + g[3 * i + 2] * rest[2]);
    solution +=
        entry * (basis_of_[k] < 0 ? Vec3(Vec3::Unit(i)) : Vec3(basis_[basis_of_[k]].col(i)));
  }
  return solution;
}

// The solution of any node, in A's directions; what it has no unknowns for is zero.
template <class T>
void NumericFactor<T>::turn_back(Index k, const T* solution, T (&to)[3]) const {
  std::fill(to, to + 3, T(0));
  if (basis_of_[k] < 0) {
    std::copy(solution, solution + dim_[k], to);
    return;
  }
  const Mat3& q = basis_[basis_of_[k]];
  for (Index i = 0; i < 3; ++i)
    for (Index r = 0; r < dim_[k]; ++r)
      to[i] += static_cast<T>(q(i, r) * static_cast<double>(solution[r]));
}

#define TAUT_INSTANTIATE(T)                                                                      \
  template void NumericFactor<T>::mark_projected(Index);                                         \
  template void NumericFactor<T>::condense_rows(Index, Index);                                   \
  template BadPivot NumericFactor<T>::condense_projected(Index);                                 \
  template double NumericFactor<T>::forward_condensed(const Front&, const FactorVectors&,        \
                                                      const double*, int);                       \
  template void NumericFactor<T>::backward_condensed(const Front&, const FactorVectors&, double, \
                                                     double*) const;
TAUT_INSTANTIATE(float)
TAUT_INSTANTIATE(double)
#undef TAUT_INSTANTIATE

}  // namespace taut
