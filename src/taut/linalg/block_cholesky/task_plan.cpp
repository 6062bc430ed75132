// Tasks, and places in the arena.

#include <algorithm>

#include "taut/linalg/block_cholesky/factor_layout.h"

namespace taut {

namespace {

// Subtrees with less than all work / (threads x this) are one task: enough of them to balance the
// threads, few enough that their updates, which get places of their own, stay small.
constexpr double tasks_per_thread = 12.0;
// Work worth handing over to another thread (some 10 microseconds).
constexpr double least_work = 5e5;

double work_of(const FrontShape& shape) {
  const double n = shape.columns, m = shape.rows - shape.columns;
  return n * n * n / 3.0 + n * n * m + n * m * m + 20.0 * n * (n + m) + 10.0 * m * m + 10'000.0;
}

std::vector<double> subtree_work(const FactorLayout& layout) {
  std::vector<double> work(layout.front.size());
  for (std::size_t s = 0; s < work.size(); ++s) {
    work[s] += work_of(layout.front[s].shape);
    if (layout.front[s].parent >= 0) work[layout.front[s].parent] += work[s];
  }
  return work;
}

// Places updates so that a front's own does not overlap its children's, and panels so that they
// overlap neither. Where children may run at the same time, their whole subtrees are kept apart;
// else only their updates are.
class ArenaPlan {
 public:
  ArenaPlan(FactorLayout& layout, std::span<const std::uint8_t> is_shared)
      : layout_(layout), is_shared_(is_shared), peak_(layout.front.size(), 0) {}

  // Subtrees are planned relative to their own begin, upwards, since their sizes are needed first;
  // then moved, from the roots down.
  void plan() {
    const Index n = static_cast<Index>(layout_.front.size());
    std::vector<Offset> begin(layout_.front.size(), 0);  // of a subtree relative to its parent's
    layout_.arena_size = layout_.scratch_size = 0;
    for (Index s = 0; s < n; ++s) plan_front(s, begin);
    for (Index s = n - 1; s >= 0; --s) {
      Front& f = layout_.front[s];
      if (f.parent < 0) {
        begin[s] = layout_.arena_size;
        layout_.arena_size += peak_[s];
      } else {
        begin[s] += begin[f.parent];
      }
      f.update += begin[s];
      if (is_task_root(s)) begin[s] = 0;  // the scratch's
      f.panel += begin[s];
    }
  }

 private:
  // Of a subtree that one thread eliminates.
  bool is_task_root(Index s) const {
    const Index p = layout_.front[s].parent;
    return !is_shared_[s] && (p < 0 || is_shared_[p]);
  }

  void plan_front(Index s, std::vector<Offset>& begin) {
    Front& f = layout_.front[s];
    f.panel_in_scratch = !is_shared_[s];
    f.update_in_scratch = !is_shared_[s] && !is_task_root(s);
    Offset next = 0, peak = 0;
    live_.clear();
    for (Index i = f.child_begin; i < f.child_end; ++i) {
      const Index c = layout_.child[i];
      const Front& child = layout_.front[c];
      begin[c] = next;
      const Offset update_begin = next + child.update,
                   update_end = update_begin + child.shape.update_size();
      live_.push_back({update_begin, update_end});
      peak = std::max(peak, next + peak_[c]);
      next = is_shared_[s] ? next + peak_[c] : std::max(next, update_end);
    }
    const Offset children_end = live_.empty() ? 0 : live_.back().second;
    if (is_task_root(s)) {
      f.panel = children_end;
      layout_.scratch_size = std::max({layout_.scratch_size, peak, f.panel + f.shape.panel_size()});
      f.update = 0;
      peak_[s] = f.shape.update_size();
      return;
    }
    f.update = first_gap(f.shape.update_size());
    f.panel = std::max(f.update + f.shape.update_size(), children_end);
    peak_[s] = std::max(peak, f.panel + f.shape.panel_size());
  }

  Offset first_gap(Offset size) {
    Offset at = 0;
    for (const auto& [begin, end] : live_) {  // ascending
      if (at + size <= begin) break;
      at = std::max(at, end);
    }
    return at;
  }

  FactorLayout& layout_;
  std::span<const std::uint8_t> is_shared_;
  std::vector<Offset> peak_;  // what each subtree takes where it is planned
  std::vector<std::pair<Offset, Offset>> live_;
};

}  // namespace

void plan_tasks(FactorLayout& layout, int threads) {
  const std::vector<double> work = subtree_work(layout);
  const Index n = static_cast<Index>(layout.front.size());
  double total = 0.0;
  for (const Front& f : layout.front)
    if (f.parent < 0) total += work[&f - layout.front.data()];
  const double limit =
      threads == 1 ? total : std::max(least_work, total / (tasks_per_thread * threads));

  std::vector<std::uint8_t> is_shared(layout.front.size());
  for (Index s = 0; s < n; ++s) is_shared[s] = work[s] > limit;
  std::vector<Index> task_of(layout.front.size(), -1), task_parent;
  layout.task.clear();
  Index begin = 0;  // fronts of the subtree at hand are contiguous
  double last_work = 0.0;
  for (Index s = 0; s < n; ++s) {
    const Index p = layout.front[s].parent;
    const bool ends_subtree = !is_shared[s] && (p < 0 || is_shared[p]);
    if (is_shared[s]) begin = s;
    if (!is_shared[s] && !ends_subtree) continue;
    // Small neighbouring subtrees with the same parent (or none) become one task.
    const bool joins_last = ends_subtree && !layout.task.empty() && !layout.task.back().shared &&
                            layout.front[layout.task.back().end - 1].parent == p &&
                            last_work + work[s] <= limit;
    if (joins_last) {
      layout.task.back().end = s + 1;
    } else {
      layout.task.push_back({begin, s + 1, is_shared[s] != 0});
    }
    last_work = joins_last ? last_work + work[s] : work[s];
    task_of[s] = static_cast<Index>(layout.task.size()) - 1;
    begin = s + 1;
  }
  for (const FrontTask& t : layout.task) {
    const Index p = layout.front[t.end - 1].parent;
    task_parent.push_back(p < 0 ? -1 : task_of[p]);
  }
  layout.task_tree = TaskTree(std::move(task_parent));
  ArenaPlan(layout, is_shared).plan();
}

}  // namespace taut
