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

namespace {

// Of a child's update, that it pays to add them to a front with several threads.
constexpr Index rows_worth_sharing = 128;

}  // namespace

template <class T>
NumericFactor<T>::NumericFactor(const SupernodeTree& tree, const CondensedGraph& graph,
                                std::span<const Index> condensed_at, const FrontKernels<T>& kernels)
    : kernels_(kernels),
      layout_(make_factor_layout(
          tree, graph, condensed_at,
          {kernels_.lanes, kernels_.slab_rows, kernels_.column_group, kernels_.packed_size})) {
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
      if (const Index dim = pattern.dim(layout_.node[k]); dim != 3)
        take(k, dim), not_plain_.push_back(k);
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
Status NumericFactor<T>::factorize(const FactorSource& source, std::span<const Index> start,
                                   std::span<const FactorLoad> loads) {
  assert(loads.size() <= vectors_.size());
  if (planned_threads_ != thread_count()) plan();
  if (loads.size() > 1 && vectors_[1].bytes() == 0) {
    vectors_[1] = AlignedArray<T>(layout_.vector_size);
    condensed_vectors_[1] = AlignedArray<T>(condensed_vectors_[0].size());
  }
  if (!source.replaced.empty() && replacement_.addend.empty())
    replacement_ = plan_replacement(source.replaced, *source.a.pattern, layout_);
  take_dims(source);
  first_bad_condensed_.store(std::numeric_limits<Index>::max(), std::memory_order_relaxed);
  gather(source);
  if (first_bad_condensed_.load(std::memory_order_relaxed) < layout_.condensed)
    return verdict(source.a);
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
  assemble(front, panel, shared);
  add_children(front, scratch, panel, true, shared);
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
  add_children(front, scratch, update, false, shared);
}

template <class T>
void NumericFactor<T>::pack(const Front& front, const T* panel, bool shared) {
  T* packed = packed_.data() + front.packed;
  const Index group = kernels_.column_group;
  const auto pack_groups = [&](Index begin, Index end) {
    kernels_.pack(front.shape, panel, packed, group * begin, group * end);
  };
  if (shared) {
    parallel_for(front.shape.columns / group, 8, pack_groups);
  } else {
    pack_groups(0, front.shape.columns / group);
  }
}

template <class T>
void NumericFactor<T>::add_children(const Front& front, T* scratch, T* target, bool target_is_panel,
                                    bool shared) {
  for (Index i = front.child_begin; i < front.child_end; ++i) {
    const Front& child = layout_.front[layout_.child[i]];
    const T* update = update_of(child, scratch);
    const Index first_run = target_is_panel ? child.run_begin : child.run_split;
    const Index end_of_runs = target_is_panel ? child.run_split : child.run_end;
    const Index first_spread = target_is_panel ? child.spread_begin : child.spread_split;
    // Each spread has rows of its own.
    const auto add = [&](Index begin, Index end) {
      const FlushSubnormals flush;
      kernels_.add_update(child.shape, update, layout_.run.data() + first_run,
                          end_of_runs - first_run, layout_.spread.data() + first_spread + begin,
                          end - begin, front.shape, target, target_is_panel);
    };
    const Index spreads = child.spread_end - first_spread;
    if (shared && child.shape.rows - child.shape.columns > rows_worth_sharing) {
      parallel_for(spreads, 4, add);
    } else {
      add(0, spreads);
    }
  }
}

template <class T>
BadPivot NumericFactor<T>::factor_panel(const Front& front, T* panel, bool shared) const {
  const Index slabs = front.shape.slabs(), columns = front.shape.columns,
              step = kernels_.panel_columns;
  for (Index begin = 0; begin < columns; begin += step) {
    const Index end = std::min(columns, begin + step), first = begin / kernels_.slab_rows;
    const Index below =
        shared ? std::min(slabs, (end + kernels_.slab_rows - 1) / kernels_.slab_rows) : slabs;
    const BadPivot bad = kernels_.eliminate(front.shape, panel, first, below, begin, end);
    if (bad.column >= 0) return bad;
    parallel_for(slabs - below, 2, [&](Index b, Index e) {
      const FlushSubnormals flush;
      kernels_.eliminate(front.shape, panel, below + b, below + e, begin, end);
    });
  }
  return {};
}

// The first bad pivot in the order of elimination: nodes and fronts that do not depend on each
// other are all eliminated, so it does not depend on the threads.
template <class T>
Status NumericFactor<T>::verdict(const BlockCsr& a) {
  if (const Index k = first_bad_condensed_.load(std::memory_order_relaxed); k < layout_.condensed) {
    BadPivot bad = condense_projected(k);  // its blocks are as they were
    // good by a rounding that the first pass had the other way
    if (bad.column < 0) bad = {2, 0.0};
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
          fmt::format("Cholesky (block, {} precision): pivot {:.3g} at unknown {} (node {}): {}",
                      precision, pivot, unknown, node,
                      finite ? "the matrix is not positive definite"
                             : "the matrix holds NaN or infinity, or overflows this precision")};
}

template class NumericFactor<float>;
template class NumericFactor<double>;

}  // namespace taut
