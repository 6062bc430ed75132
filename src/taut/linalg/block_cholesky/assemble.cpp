// NumericFactor: a front's columns from the blocks gathered from A, less what condensed
// nodes leave (condensation.h).

#include <algorithm>

#include "taut/base/flush_subnormals.h"
#include "taut/base/parallel.h"
#include "taut/base/simd.h"
#include "taut/linalg/block_cholesky/numeric_factor.h"
#include "taut/linalg/block_cholesky/quad.h"

namespace taut {

namespace {

// of a front that several threads share
constexpr Index nodes_per_task = 8, entries_per_task = 1 << 15;

// Block e, A_jk, less the products Uᵀ_ij U_ik: row by row, the fourth number of each nobody's.
template <class T>
TAUT_ALWAYS_INLINE void take_block(const FactorLayout& layout, const T* gathered, Index e,
                                   const T* block, typename Quad<T>::Type (&row)[3]) {
  for (Index j = 0; j < 3; ++j) row[j] = quad(block + 3 * j);
  if (layout.condensed == 0) return;
  const CondensedPair* stop = layout.pair.data() + layout.pair_start[e + 1];
  for (const CondensedPair* pair = layout.pair.data() + layout.pair_start[e]; pair < stop; ++pair) {
    const T *left = gathered + Offset{9} * pair->first,
            *right = gathered + Offset{9} * pair->second;
    for (Index r = 0; r < 3; ++r)
      for (Index j = 0; j < 3; ++j) row[j] -= left[3 * r + j] * quad(right + 3 * r);
  }
}

// A block, `width` numbers a row, whose rows are columns of the panel; of one on the diagonal the
// lower triangle.
template <class T, class From>
TAUT_ALWAYS_INLINE void put_block(const BlockPlace& place, const From* block, Index width,
                                  Index rows, Index columns, bool is_diagonal, T* column,
                                  Index slab_rows) {
  for (Index i = 0; i < rows; ++i) {
    T* to = column +
            (i < place.rows_in_slab ? place.offset + i : place.next_slab + i - place.rows_in_slab);
    for (Index j = 0; j < (is_diagonal ? i + 1 : columns); ++j)
      to[j * slab_rows] = static_cast<T>(block[j * width + i]);
  }
}

// The columns of plain nodes at places begin ... end-1, up to the first one that is not plain or
// has a block with one that is not, whose other blocks are done. Returns its place, or `end`.
template <class T>
TAUT_ALWAYS_INLINE Index assemble_plain(const FactorLayout& layout, const std::uint8_t* is_plain,
                                        const T* gathered, Index begin, Index end, Index slab_rows,
                                        T* panel) {
  using Four = typename Quad<T>::Type;
  for (Index k = begin; k < end; ++k) {
    if (!is_plain[k]) return k;
    bool are_plain = true;
    const T* block = gathered + layout.gathered_start[k];
    T* column = panel + Offset{layout.node_column[k]} * slab_rows;
    for (Index e = layout.block_start[k]; e < layout.block_start[k + 1]; ++e) {
      const BlockPlace& place = layout.block[e];
      if (is_plain[place.place]) {
        Four row[3];
        take_block(layout, gathered, e, block, row);
        if (place.place != k && place.rows_in_slab >= 3) {
          for (Index j = 0; j < 3; ++j) put_three(row[j], column + place.offset + j * slab_rows);
        } else {
          put_block(place, reinterpret_cast<const T*>(row), 4, 3, 3, place.place == k, column,
                    slab_rows);
        }
      } else {
        are_plain = false;
      }
      block += 3 * layout.node_weight[place.place];
    }
    if (!are_plain) return k;
  }
  return end;
}

TAUT_MULTIVERSION Index assemble_some(const FactorLayout& layout, const std::uint8_t* is_plain,
                                      const float* gathered, Index begin, Index end,
                                      Index slab_rows, float* panel) {
  return assemble_plain(layout, is_plain, gathered, begin, end, slab_rows, panel);
}
TAUT_MULTIVERSION Index assemble_some(const FactorLayout& layout, const std::uint8_t* is_plain,
                                      const double* gathered, Index begin, Index end,
                                      Index slab_rows, double* panel) {
  return assemble_plain(layout, is_plain, gathered, begin, end, slab_rows, panel);
}

// B := (first `rows` columns of left)ᵀ B (first `columns` columns of right); null: the identity. B:
// 3x3 row-major.
void project(const Mat3* left, Index rows, const Mat3* right, Index columns, double* block) {
  using Block = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  Eigen::Map<Block> b(block);
  if (left) b.topRows(rows) = (left->leftCols(rows).transpose() * b).eval();
  if (right) b.leftCols(columns) = (b * right->leftCols(columns)).eval();
}

}  // namespace

template <class T>
void NumericFactor<T>::assemble(const Front& front, T* panel, bool shared) const {
  const Index slab_rows = front.shape.slab_rows;
  const auto clear = [&](Offset begin, Offset end) { std::fill(panel + begin, panel + end, T(0)); };
  const auto assemble_nodes = [&](Index begin, Index end) {
    const FlushSubnormals flush;
    begin += front.first_node, end += front.first_node;
    for (Index k = begin; k < end; ++k) {
      k = assemble_some(layout_, is_plain_.data(), gathered_.data(), k, end, slab_rows, panel);
      if (k < end) assemble_projected(front, k, panel);
    }
  };
  const Offset size = front.shape.panel_size();
  const Index nodes = front.last_node - front.first_node;
  if (shared) {
    const Index pieces = static_cast<Index>((size + entries_per_task - 1) / entries_per_task);
    parallel_for(pieces, 1, [&](Index begin, Index end) {
      clear(Offset{entries_per_task} * begin, std::min(size, Offset{entries_per_task} * end));
    });
    parallel_for(nodes, nodes_per_task, assemble_nodes);
  } else {
    clear(0, size);
    assemble_nodes(0, nodes);
  }
  for (Index j = 0; j < front.shape.padding; ++j)
    panel[front.shape.panel_offset(j / slab_rows) + Offset{j} * slab_rows + j % slab_rows] = T(1);
}

// Of the node at place k, the blocks that assemble_plain() leaves: of any size, projected where a
// node has a basis of its own.
template <class T>
void NumericFactor<T>::assemble_projected(const Front& front, Index k, T* panel) const {
  const Index slab_rows = front.shape.slab_rows, dim = dim_[k], weight = layout_.node_weight[k],
              basis = basis_of_[k];
  const auto set_one = [&](Index j) {
    panel[front.shape.panel_offset(j / slab_rows) + Offset{j} * slab_rows + j % slab_rows] = T(1);
  };
  for (Index j = dim; j < weight; ++j) set_one(layout_.node_column[k] + j);
  if (dim == 0) return;
  const T* block = gathered_.data() + layout_.gathered_start[k];
  T* column = panel + Offset{layout_.node_column[k]} * slab_rows;
  for (Index e = layout_.block_start[k]; e < layout_.block_start[k + 1]; ++e) {
    const BlockPlace& place = layout_.block[e];
    const Index other = place.place, other_dim = dim_[other], other_basis = basis_of_[other],
                width = layout_.node_weight[other];
    if (!is_plain_[k] || !is_plain_[other]) {
      T taken[12];
      const T* numbers = block;
      if (layout_.condensed > 0) {
        typename Quad<T>::Type row[3];
        take_block(layout_, gathered_.data(), e, block, row);
        for (Index j = 0; j < 3; ++j) put_three(row[j], taken + 3 * j);
        numbers = taken;
      }
      if (basis < 0 && other_basis < 0) {
        put_block(place, numbers, width, other_dim, dim, other == k, column, slab_rows);
      } else {
        double projected[9];
        for (Index j = 0; j < 9; ++j) projected[j] = static_cast<double>(numbers[j]);
        project(basis >= 0 ? &basis_[basis] : nullptr, dim,
                other_basis >= 0 ? &basis_[other_basis] : nullptr, other_dim, projected);
        put_block(place, projected, 3, other_dim, dim, other == k, column, slab_rows);
      }
    }
    block += weight * width;
  }
}

template void NumericFactor<float>::assemble(const Front&, float*, bool) const;
template void NumericFactor<double>::assemble(const Front&, double*, bool) const;

}  // namespace taut
