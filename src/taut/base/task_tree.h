#pragma once
// Tasks that form a forest, run in parallel:
//
//   run_upwards(tree, f)     f(t) once for every task, after all its children
//   run_downwards(tree, f)   f(t) once for every task, after its parent
//
// Tasks are numbered so that parents come after their children. f is called from several threads;
// what it computes must not depend on which tasks ran before, but for those above. A task may
// itself run parallel loops. With one thread the tasks run in the order of their numbers
// (downwards: reversed). The way down goes back the way up, so that a thread finds most of what it
// reads in its own cache. Side tasks, which need nothing of the tree's and nothing needs, fill the
// time near the root, where there are fewer tasks than threads. One run of a tree at a time: it
// keeps the counters of open children, so that a run allocates nothing itself.

#include <atomic>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "taut/base/types.h"

namespace taut {

struct SideTasks {
  Index count = 0;
  std::function<void(Index)> body;  // body(k) once for each of them
};

class TaskTree {
 public:
  TaskTree() = default;
  // parent[t] > t, or -1 for a root. Asserted.
  explicit TaskTree(std::vector<Index> parent);
  Index size() const { return static_cast<Index>(parent_.size()); }
  Index parent(Index t) const { return parent_[t]; }
  std::span<const Index> children(Index t) const {
    return {child_.data() + child_start_[t], child_.data() + child_start_[t + 1]};
  }
  std::span<const Index> leaves() const { return leaves_; }
  std::span<const Index> roots() const { return roots_; }

 private:
  friend void run_upwards(TaskTree&, const std::function<void(Index)>&, const SideTasks&);
  friend void run_downwards(const TaskTree&, const std::function<void(Index)>&);
  void plan_way_down();

  std::vector<Index> parent_, child_start_, child_, leaves_, roots_;
  // child_ once more: first the one to go on with, then the others in the order in which they are
  // left to be taken
  std::vector<Index> child_down_;
  std::unique_ptr<std::atomic<Index>[]> open_children_;
};

void run_upwards(TaskTree& tree, const std::function<void(Index)>& body,
                 const SideTasks& beside = {});
void run_downwards(const TaskTree& tree, const std::function<void(Index)>& body);

}  // namespace taut
