// Trees of tasks: each once, in the tree's order, with side tasks.

#include "taut/base/task_tree.h"

#include <gtest/gtest.h>

#include <mutex>

#include "taut/base/parallel.h"

namespace taut::test {
namespace {

class TasksInParallel : public testing::Test {
 protected:
  ~TasksInParallel() override { set_thread_count(before_); }
  const int before_ = thread_count();
  const std::vector<std::vector<Index>> parents_ = {
      {},
      {-1},
      {-1, -1, -1},
      {1, 2, 3, -1},
      {2, 2, 6, 5, 5, 6, -1},
      {4, 4, 4, 4, -1, 6, -1},
      {4, 4, 4, 4, 16, 7, 7, 16, 14, 14, 13, 13, 13, 14, 16, 16, -1}};
};

// When each task ran, in any order that two threads can be told apart by.
std::vector<int> visits(TaskTree& tree, bool upwards, const SideTasks& beside = {}) {
  std::vector<int> when(static_cast<std::size_t>(tree.size()), -1);
  std::mutex mutex;
  int now = 0;
  const auto body = [&](Index t) {
    const std::lock_guard lock(mutex);
    EXPECT_EQ(when[t], -1) << t;
    when[t] = now++;
  };
  if (upwards) {
    run_upwards(tree, body, beside);
  } else {
    run_downwards(tree, body);
  }
  return when;
}

TEST_F(TasksInParallel, EachTaskRunsOnceAndInItsPlace) {
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    for (const auto& parent : parents_) {
      TaskTree tree(parent);
      for (const bool upwards : {true, false}) {
        const std::vector<int> when = visits(tree, upwards);
        for (Index t = 0; t < tree.size(); ++t) {
          EXPECT_GE(when[t], 0);
          if (parent[t] >= 0) {
            EXPECT_EQ(when[t] < when[parent[t]], upwards) << t;
          }
        }
      }
    }
  }
}

// Whatever the tree, and also when it is empty: all are done when the run is over.
TEST_F(TasksInParallel, SideTasksRunOnce) {
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    for (const auto& parent : parents_)
      for (const Index count : {0, 1, 20}) {
        TaskTree tree(parent);
        std::vector<std::atomic<int>> runs(static_cast<std::size_t>(count));
        visits(tree, true, {count, [&](Index k) { ++runs[k]; }});
        for (Index k = 0; k < count; ++k)
          EXPECT_EQ(runs[k], 1) << k << " of " << count << ", tree of " << parent.size();
      }
  }
}

}  // namespace
}  // namespace taut::test
