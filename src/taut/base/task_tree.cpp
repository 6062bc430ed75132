#include "taut/base/task_tree.h"

#include <algorithm>
#include <cassert>

#include "taut/base/parallel.h"

namespace taut {

TaskTree::TaskTree(std::vector<Index> parent)
    : parent_(std::move(parent)), child_start_(parent_.size() + 1, 0) {
  const Index n = size();
  for (Index t = 0; t < n; ++t) {
    assert(parent_[t] == -1 || (parent_[t] > t && parent_[t] < n));
    if (parent_[t] < 0) {
      roots_.push_back(t);
    } else {
      ++child_start_[parent_[t] + 1];
    }
  }
  for (Index t = 0; t < n; ++t) child_start_[t + 1] += child_start_[t];
  child_.resize(parent_.size() - roots_.size());
  std::vector<Index> next(child_start_.begin(), child_start_.end() - 1);
  for (Index t = 0; t < n; ++t) {
    if (parent_[t] >= 0) child_[next[parent_[t]]++] = t;
    if (children(t).empty()) leaves_.push_back(t);
  }
  open_children_ = std::make_unique<std::atomic<Index>[]>(parent_.size());
  plan_way_down();
}

// On the way up the thread that started the run takes leaves from the last one on, the others
// from the first one on, and they meet in the middle. So on the way down they begin there:
// children near the middle come first. Of what is left to be taken, others take the oldest, the
// thread itself the youngest.
void TaskTree::plan_way_down() {
  std::vector<Index> first_leaf(parent_.size()), end_leaf(parent_.size());
  for (Index t = 0, leaf = 0; t < size(); ++t) {
    const auto below = children(t);
    first_leaf[t] = below.empty() ? leaf++ : first_leaf[below.front()];
    end_leaf[t] = leaf;
  }
  const Index middle = static_cast<Index>(leaves_.size()) / 2;
  const auto distance = [&](Index t) {
    return std::max({Index{0}, first_leaf[t] - middle, middle - end_leaf[t]});
  };
  child_down_ = child_;
  for (Index t = 0; t < size(); ++t) {
    const auto begin = child_down_.begin() + child_start_[t],
               end = child_down_.begin() + child_start_[t + 1];
    if (begin == end) continue;
    std::iter_swap(begin, std::min_element(begin, end, [&](Index a, Index b) {
                     return distance(a) < distance(b);
                   }));
    std::sort(begin + 1, end, [&](Index a, Index b) {
      const bool a_is_behind = first_leaf[a] >= middle, b_is_behind = first_leaf[b] >= middle;
      return a_is_behind != b_is_behind ? b_is_behind : distance(a) > distance(b);
    });
  }
}

void run_upwards(TaskTree& tree, const std::function<void(Index)>& body, const SideTasks& beside) {
  const Index tasks = tree.size();
  if (thread_count() == 1 || tasks < 2) {
    for (Index t = 0; t < tasks; ++t) body(t);
    for (Index k = 0; k < beside.count; ++k) beside.body(k);
    return;
  }
  for (Index t = 0; t < tasks; ++t)
    tree.open_children_[t] = static_cast<Index>(tree.children(t).size());
  std::atomic<Index> leaves_left = static_cast<Index>(tree.leaves().size());
  std::atomic<bool> side_tasks_left = beside.count > 0;
  // Side tasks are numbered behind the tree's.
  detail::run_tasks(tree.leaves(), [&](Index t, detail::Spawner& spawn) {
    if (t >= tasks) return beside.body(t - tasks);
    if (tree.children(t).empty()) --leaves_left;
    // Whoever finishes the last child goes on with the parent.
    for (;;) {
      body(t);
      t = tree.parent(t);
      if (t < 0 || --tree.open_children_[t] > 0) break;
    }
    // What is left of the tree others are at work on. At the latest this is after the last root.
    if (leaves_left == 0 && side_tasks_left.exchange(false))
      for (Index k = 0; k < beside.count; ++k) spawn(tasks + k);
  });
}

void run_downwards(const TaskTree& tree, const std::function<void(Index)>& body) {
  if (thread_count() == 1 || tree.size() < 2) {
    for (Index t = tree.size() - 1; t >= 0; --t) body(t);
    return;
  }
  detail::run_tasks(tree.roots(), [&](Index t, detail::Spawner& spawn) {
    for (;;) {
      body(t);
      const Index begin = tree.child_start_[t], end = tree.child_start_[t + 1];
      if (begin == end) return;
      for (Index k = begin + 1; k < end; ++k) spawn(tree.child_down_[k]);
      t = tree.child_down_[begin];
    }
  });
}

}  // namespace taut
