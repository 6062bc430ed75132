#include "taut/base/task_tree.h"

#include <cassert>

#include "taut/base/parallel.h"

namespace taut {

TaskTree::TaskTree(std::vector<Index> parent) : parent_(std::move(parent)), child_start_(parent_.size() + 1, 0) {
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
}

void run_upwards(TaskTree& tree, const std::function<void(Index)>& body, const SideTasks& beside) {
  const Index tasks = tree.size();
  if (thread_count() == 1 || tasks < 2) {
    for (Index t = 0; t < tasks; ++t) body(t);
    for (Index k = 0; k < beside.count; ++k) beside.body(k);
    return;
  }
  for (Index t = 0; t < tasks; ++t) tree.open_children_[t] = static_cast<Index>(tree.children(t).size());
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
      const auto children = tree.children(t);
      if (children.empty()) return;
      for (const Index child : children.subspan(1)) spawn(child);
      t = children.front();
    }
  });
}

}  // namespace taut
