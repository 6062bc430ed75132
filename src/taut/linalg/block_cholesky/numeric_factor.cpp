#include "taut/linalg/block_cholesky/numeric_factor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/base/parallel.h"

namespace taut {

template <class T>
NumericFactor<T>::NumericFactor(const SupernodeTree& tree, const AnalyzedGraph& graph)
    : kernels_(front_kernels<T>()), layout_(make_factor_layout(tree, graph, kernels_.slab_rows, kernels_.column_group)) {
  panels_ = AlignedArray<T>(layout_.panel_size);
  vectors_ = AlignedArray<T>(layout_.vector_size);
  fate_.resize(layout_.front.size());
  bad_pivot_.resize(layout_.front.size());
  dim_.resize(layout_.node.size());
  plan();
}

template <class T>
void NumericFactor<T>::plan() {
  planned_threads_ = thread_count();
  plan_tasks(layout_, planned_threads_);
  // add_update reads up to slab_rows elements around an update.
  updates_ = AlignedArray<T>(layout_.update_size + 2 * Offset{kernels_.slab_rows});
}

template <class T>
Status NumericFactor<T>::factorize(const BlockCsr& a) {
  if (planned_threads_ != thread_count()) plan();
  for (std::size_t k = 0; k < dim_.size(); ++k) dim_[k] = a.pattern->dim(layout_.node[k]);
  const auto run = [&](Index t) {
    const FrontTask& task = layout_.task[t];
    for (Index s = task.begin; s < task.end; ++s) eliminate(a, s, task.shared);
  };
  run_upwards(layout_.task_tree, std::ref(run));
  return verdict(a);
}

template <class T>
void NumericFactor<T>::eliminate(const BlockCsr& a, Index s, bool shared) {
  const Front& front = layout_.front[s];
  for (Index i = front.child_begin; i < front.child_end; ++i)
    if (fate_[layout_.child[i]] != Fate::eliminated) {
      fate_[s] = Fate::skipped;
      return;
    }
  T* panel = panels_.data() + front.panel;
  std::fill(panel, panel + front.shape.panel_size(), T(0));
  assemble(a, front, panel);
  add_children(front, panel, true);
  bad_pivot_[s] = factor_panel(front, panel, shared);
  fate_[s] = bad_pivot_[s].column < 0 ? Fate::eliminated : Fate::bad_pivot;
  const Index tiles = front.shape.update_tiles();
  if (tiles == 0 || fate_[s] != Fate::eliminated) return;

  T* update = updates_.data() + kernels_.slab_rows + front.update;
  if (shared) {
    parallel_for(tiles, 4, [&](Index begin, Index end) { kernels_.form_update(front.shape, panel, update, begin, end); });
  } else {
    kernels_.form_update(front.shape, panel, update, 0, tiles);
  }
  add_children(front, update, false);
}

template <class T>
void NumericFactor<T>::assemble(const BlockCsr& a, const Front& front, T* panel) const {
  const BlockPattern& p = *a.pattern;
  const Index r = front.shape.slab_rows;
  const auto element = [&](Index row, Index column) -> T& {
    return panel[front.shape.panel_offset(row / r) + Offset{column} * r + row % r];
  };
  for (Index k = front.first_node; k < front.last_node; ++k) {
    const Index node = layout_.node[k], dim = dim_[k], column = layout_.node_column[k];
    const double* values = a.values.data() + p.value_start[node];
    const Index width = p.width(node);
    const BlockPlace* place = layout_.block.data() + layout_.block_start[k];
    const BlockPlace* end = layout_.block.data() + layout_.block_start[k + 1];
    // Row `node` of A read across is the pivots' column read down.
    for (Index e = p.row_start[node]; e < p.row_start[node + 1] && place < end; ++e) {
      const Index other = p.column[e];
      while (place < end && place->node < other) ++place;
      if (place == end || place->node != other) continue;  // above the diagonal
      const double* block = values + p.block_offset[e];
      const Index other_dim = p.dim(other);
      for (Index i = 0; i < other_dim; ++i)
        for (Index j = 0; j < dim && (other != node || j <= i); ++j)
          element(place->row + i, column + j) = static_cast<T>(block[j * width + i]);
    }
    for (Index j = dim; j < layout_.node_weight[k]; ++j) element(column + j, column + j) = T(1);
  }
  for (Index j = front.pivots; j < front.shape.columns; ++j) element(j, j) = T(1);
}

template <class T>
void NumericFactor<T>::add_children(const Front& front, T* target, bool target_is_panel) {
  for (Index i = front.child_begin; i < front.child_end; ++i) {
    const Front& child = layout_.front[layout_.child[i]];
    const Index split = child.piece_split - child.piece_begin, end = child.piece_end - child.piece_begin;
    kernels_.add_update(child.shape, updates_.data() + kernels_.slab_rows + child.update, layout_.piece.data() + child.piece_begin,
                        target_is_panel ? 0 : split, target_is_panel ? split : end, target_is_panel ? 0 : split, end, front.shape, target,
                        target_is_panel);
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
    parallel_for(slabs - below, 2, [&](Index b, Index e) { kernels_.eliminate(front.shape, panel, below + b, below + e, begin, end); });
  }
  return {};
}

// The first bad pivot in the order of elimination: fronts that do not depend on each other are all eliminated, so it does not depend on the
// threads.
template <class T>
Status NumericFactor<T>::verdict(const BlockCsr& a) const {
  const auto it = std::find(fate_.begin(), fate_.end(), Fate::bad_pivot);
  if (it == fate_.end()) return {};
  const auto s = it - fate_.begin();
  const Front& front = layout_.front[s];
  const BadPivot& bad = bad_pivot_[s];
  Index k = front.last_node - 1;
  while (k > front.first_node && layout_.node_column[k] > bad.column) --k;
  const Index node = layout_.node[k], unknown = a.pattern->dof_start[node] + bad.column - layout_.node_column[k];
  const char* precision = sizeof(T) == 4 ? "single" : "double";
  const bool finite = std::isfinite(bad.value);
  return {finite ? Outcome::not_positive_definite : Outcome::not_finite,
          fmt::format("Cholesky (block, {} precision): pivot {:.3g} at unknown {} (node {}): {}", precision, bad.value, unknown, node,
                      finite ? "the matrix is not positive definite" : "the matrix holds NaN or infinity, or overflows this precision")};
}

template class NumericFactor<float>;
template class NumericFactor<double>;

}  // namespace taut
