#include "taut/linalg/block_cholesky/numeric_factor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "taut/base/flush_subnormals.h"
#include "taut/base/parallel.h"
#include "taut/base/simd.h"

namespace taut {

template <class T>
NumericFactor<T>::NumericFactor(const SupernodeTree& tree, const CondensedGraph& graph, std::span<const Index> condensed_at, const FrontKernels<T>& kernels)
    : kernels_(kernels),
      layout_(make_factor_layout(tree, graph, condensed_at, {kernels_.lanes, kernels_.slab_rows, kernels_.column_group, kernels_.packed_size})) {
  gathered_ = AlignedArray<T>(layout_.gathered_size + read_too_many);
  packed_ = AlignedArray<T>(layout_.packed_size);
  vectors_[0] = AlignedArray<T>(layout_.vector_size);
  fate_.resize(layout_.front.size());
  bad_pivot_.resize(layout_.front.size());
  for (auto& parts : norm2_) parts.resize(layout_.front.size());
  is_plain_with_neighbours_.resize(static_cast<std::size_t>(layout_.condensed));
  condensed_vectors_[0] = AlignedArray<T>(Offset{4} * layout_.condensed);
  dim_.resize(layout_.node.size(), 3);
  is_plain_.resize(layout_.node.size(), 1);
  basis_of_.resize(layout_.node.size(), -1);
  plan();
}

template <class T>
void NumericFactor<T>::plan() {
  planned_threads_ = thread_count();
  plan_tasks(layout_, planned_threads_);
  arena_ = AlignedArray<T>(layout_.arena_size);
  // Of different threads on pages of their own.
  constexpr Offset page = 4096 / sizeof(T);
  scratch_of_thread_ = (layout_.scratch_size + page - 1) / page * page;
  scratch_ = AlignedArray<T>(scratch_of_thread_ * planned_threads_);
}

template <class T>
void NumericFactor<T>::take_dims(const FactorSource& source) {
  const BlockPattern& pattern = *source.a.pattern;
  const auto take = [&](Index k, Index dim) {
    dim_[k] = dim;
    is_plain_[k] = dim == 3;
    basis_of_[k] = -1;
  };
  for (const Index k : not_plain_) take(k, 3);
  not_plain_.clear();
  basis_.clear();
  if (pattern.uniform_dim != 3)
    for (std::size_t k = 0; k < dim_.size(); ++k)
      if (const Index dim = pattern.dim(layout_.node[k]); dim != 3) take(k, dim), not_plain_.push_back(k);
  for_each_projected(source.basis.dim, [&](Index node) {
    const Index k = layout_.place[node];
    if (k < 0) return;
    take(k, source.basis.dim[node]);
    not_plain_.push_back(k);
    basis_of_[k] = static_cast<Index>(basis_.size());
    basis_.push_back(source.basis.frame[node]);
  });
  if (layout_.condensed == 0) return;
  std::ranges::fill(is_plain_with_neighbours_, std::uint8_t{1});
  for (const Index k : not_plain_) mark_projected(k);
}

template <class T>
Status NumericFactor<T>::factorize(const FactorSource& source, std::span<const Index> start, std::span<const FactorLoad> loads) {
  assert(loads.size() <= vectors_.size());
  if (planned_threads_ != thread_count()) plan();
  if (loads.size() > 1 && vectors_[1].bytes() == 0) {
    vectors_[1] = AlignedArray<T>(layout_.vector_size);
    condensed_vectors_[1] = AlignedArray<T>(condensed_vectors_[0].size());
  }
  if (!source.replaced.empty() && replacement_.addend.empty()) replacement_ = plan_replacement(source.replaced, *source.a.pattern, layout_);
  take_dims(source);
  first_bad_condensed_.store(std::numeric_limits<Index>::max(), std::memory_order_relaxed);
  gather(source);
  if (!subtract_condensed()) return verdict(source.a);
  const auto run = [&](Index t) {
    const FlushSubnormals flush;
    const FrontTask& task = layout_.task[t];
    T* scratch = scratch_.data() + scratch_of_thread_ * thread_slot();
    for (Index s = task.begin; s < task.end; ++s) {
      eliminate(s, task.shared, scratch);
      if (fate_[s] != Fate::eliminated) continue;
      for (std::size_t k = 0; k < loads.size(); ++k)
        forward(s, {start, loads[k].scale}, loads[k].b, static_cast<int>(loads.size() - 1 - k));
    }
  };
  run_upwards(layout_.task_tree, std::ref(run), source.beside ? *source.beside : SideTasks{});
  return verdict(source.a);
}

template <class T>
void NumericFactor<T>::eliminate(Index s, bool shared, T* scratch) {
  const Front& front = layout_.front[s];
  for (Index i = front.child_begin; i < front.child_end; ++i)
    if (fate_[layout_.child[i]] != Fate::eliminated) {
      fate_[s] = Fate::skipped;
      return;
    }
  T* panel = (front.panel_in_scratch ? scratch : arena_.data()) + front.panel;
  std::fill(panel, panel + front.shape.panel_size(), T(0));
  assemble(front, panel);
  add_children(front, scratch, panel, true);
  bad_pivot_[s] = factor_panel(front, panel, shared);
  fate_[s] = bad_pivot_[s].column < 0 ? Fate::eliminated : Fate::bad_pivot;
  if (fate_[s] != Fate::eliminated) return;
  form_update(front, scratch, panel, shared);
  pack(front, panel, shared);
}

template <class T>
void NumericFactor<T>::form_update(const Front& front, T* scratch, const T* panel, bool shared) {
  const Index tiles = front.shape.update_tiles();
  if (tiles == 0) return;
  T* update = update_of(front, scratch);
  if (shared) {
    parallel_for(tiles, 2, [&](Index begin, Index end) {
      const FlushSubnormals flush;
      kernels_.form_update(front.shape, panel, update, begin, end);
    });
  } else {
    kernels_.form_update(front.shape, panel, update, 0, tiles);
  }
  add_children(front, scratch, update, false);
}

template <class T>
void NumericFactor<T>::pack(const Front& front, const T* panel, bool shared) {
  T* packed = packed_.data() + front.packed;
  const Index group = kernels_.column_group;
  const auto pack_groups = [&](Index begin, Index end) { kernels_.pack(front.shape, panel, packed, group * begin, group * end); };
  if (shared) {
    parallel_for(front.shape.columns / group, 8, pack_groups);
  } else {
    pack_groups(0, front.shape.columns / group);
  }
}

template <class T>
void NumericFactor<T>::assemble(const Front& front, T* panel) const {
  const Index r = front.shape.slab_rows;
  const auto set_one = [&](Index j) { panel[front.shape.panel_offset(j / r) + Offset{j} * r + j % r] = T(1); };
  for (Index k = front.first_node; k < front.last_node; ++k) {
    assemble_node(front, k, panel);
    for (Index j = dim_[k]; j < layout_.node_weight[k]; ++j) set_one(layout_.node_column[k] + j);
  }
  for (Index j = 0; j < front.shape.padding; ++j) set_one(j);
}

namespace {

// B := (first `rows` columns of left)ᵀ B (first `columns` columns of right); null: the identity. B: 3x3 row-major.
void project(const Mat3* left, Index rows, const Mat3* right, Index columns, double* block) {
  using Block = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  Eigen::Map<Block> b(block);
  if (left) b.topRows(rows) = (left->leftCols(rows).transpose() * b).eval();
  if (right) b.leftCols(columns) = (b * right->leftCols(columns)).eval();
}

// A gathered block, `width` numbers a column; of one on the diagonal the lower triangle.
template <class T, class From>
TAUT_ALWAYS_INLINE void put_block(const BlockPlace& place, const From* block, Index width, Index rows, Index columns, bool is_diagonal,
                                  T* column, Index r) {
  for (Index i = 0; i < rows; ++i) {
    T* to = column + (i < place.rows_in_slab ? place.offset + i : place.next_slab + i - place.rows_in_slab);
    for (Index j = 0; j < (is_diagonal ? i + 1 : columns); ++j) to[j * r] = static_cast<T>(block[j * width + i]);
  }
}

// Three numbers. Reads a fourth and adds nothing to the fourth place.
template <class T>
TAUT_ALWAYS_INLINE void add_three(const T* from, T* to) {
  typedef T Four __attribute__((vector_size(4 * sizeof(T)), aligned(sizeof(T)), may_alias));
  typedef std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t> Mask __attribute__((vector_size(4 * sizeof(T))));
  const Mask first_three = {-1, -1, -1, 0};
  *reinterpret_cast<Four*>(to) += (Four)((Mask) * reinterpret_cast<const Four*>(from) & first_three);
}

}  // namespace

template <class T>
void NumericFactor<T>::assemble_node(const Front& front, Index k, T* panel) const {
  const Index r = front.shape.slab_rows, weight = layout_.node_weight[k];
  if (dim_[k] == 0) return;
  const T* block = gathered_.data() + layout_.gathered_start[k];
  T* column = panel + Offset{layout_.node_column[k]} * r;
  for (Index e = layout_.block_start[k]; e < layout_.block_start[k + 1]; ++e) {
    const BlockPlace& place = layout_.block[e];
    if (!is_plain_[k] || !is_plain_[place.place]) {
      assemble_projected(place, k, block, column, r);
    } else if (place.place != k && place.rows_in_slab > 3) {
      // Four are read and written in each column of the block: there are as many.
      for (Index j = 0; j < 3; ++j) add_three(block + 3 * j, column + place.offset + j * r);
    } else {
      put_block(place, block, 3, 3, 3, place.place == k, column, r);
    }
    block += weight * layout_.node_weight[place.place];
  }
}

// Blocks of any size, projected where a node has a basis of its own.
template <class T>
void NumericFactor<T>::assemble_projected(const BlockPlace& place, Index k, const T* block, T* column, Index r) const {
  const Index dim = dim_[k], other_dim = dim_[place.place], basis = basis_of_[k], other_basis = basis_of_[place.place];
  if (basis < 0 && other_basis < 0) return put_block(place, block, layout_.node_weight[place.place], other_dim, dim, place.place == k, column, r);
  double projected[9];
  for (Index j = 0; j < 9; ++j) projected[j] = static_cast<double>(block[j]);
  project(basis >= 0 ? &basis_[basis] : nullptr, dim, other_basis >= 0 ? &basis_[other_basis] : nullptr, other_dim, projected);
  put_block(place, projected, 3, other_dim, dim, place.place == k, column, r);
}

template <class T>
void NumericFactor<T>::add_children(const Front& front, T* scratch, T* target, bool target_is_panel) {
  for (Index i = front.child_begin; i < front.child_end; ++i) {
    const Front& child = layout_.front[layout_.child[i]];
    const T* update = update_of(child, scratch);
    const Index first_run = target_is_panel ? child.run_begin : child.run_split;
    const Index end_of_runs = target_is_panel ? child.run_split : child.run_end;
    const Index first_spread = target_is_panel ? child.spread_begin : child.spread_split;
    kernels_.add_update(child.shape, update, layout_.run.data() + first_run, end_of_runs - first_run, layout_.spread.data() + first_spread,
                        child.spread_end - first_spread, front.shape, target, target_is_panel);
  }
}

template <class T>
BadPivot NumericFactor<T>::factor_panel(const Front& front, T* panel, bool shared) const {
  const Index slabs = front.shape.slabs(), columns = front.shape.columns, step = kernels_.panel_columns;
  for (Index begin = 0; begin < columns; begin += step) {
    const Index end = std::min(columns, begin + step), first = begin / kernels_.slab_rows;
    const Index below = shared ? std::min(slabs, (end + kernels_.slab_rows - 1) / kernels_.slab_rows) : slabs;
    const BadPivot bad = kernels_.eliminate(front.shape, panel, first, below, begin, end);
    if (bad.column >= 0) return bad;
    parallel_for(slabs - below, 2, [&](Index b, Index e) {
      const FlushSubnormals flush;
      kernels_.eliminate(front.shape, panel, below + b, below + e, begin, end);
    });
  }
  return {};
}

// The first bad pivot in the order of elimination: nodes and fronts that do not depend on each other are all eliminated, so it does not
// depend on the threads.
template <class T>
Status NumericFactor<T>::verdict(const BlockCsr& a) {
  if (const Index k = first_bad_condensed_.load(std::memory_order_relaxed); k < layout_.condensed) {
    BadPivot bad = condense_projected(k);  // its blocks are as they were
    if (bad.column < 0) bad = {2, 0.0};    // good by a rounding that the first pass had the other way
    return failure(a, k, bad.column, bad.value);
  }
  const auto it = std::find(fate_.begin(), fate_.end(), Fate::bad_pivot);
  if (it == fate_.end()) return {};
  const auto s = it - fate_.begin();
  const Front& front = layout_.front[s];
  const BadPivot& bad = bad_pivot_[s];
  Index k = front.last_node - 1;
  while (k > front.first_node && layout_.node_column[k] > bad.column) --k;
  return failure(a, k, bad.column - layout_.node_column[k], bad.value);
}

template <class T>
Status NumericFactor<T>::failure(const BlockCsr& a, Index k, Index component, double pivot) const {
  const Index node = layout_.node[k], unknown = a.pattern->dof_start[node] + component;
  const char* precision = sizeof(T) == 4 ? "single" : "double";
  const bool finite = std::isfinite(pivot);
  return {finite ? Outcome::not_positive_definite : Outcome::not_finite,
          fmt::format("Cholesky (block, {} precision): pivot {:.3g} at unknown {} (node {}): {}", precision, pivot, unknown, node,
                      finite ? "the matrix is not positive definite" : "the matrix holds NaN or infinity, or overflows this precision")};
}

template class NumericFactor<float>;
template class NumericFactor<double>;

}  // namespace taut
