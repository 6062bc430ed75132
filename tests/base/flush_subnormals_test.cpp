#include "taut/base/flush_subnormals.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "taut/base/parallel.h"
#include "taut/base/task_tree.h"

namespace taut::test {
namespace {

// Half of the smallest normal number: zero where subnormal ones are flushed. Volatile: computed
// here and now.
bool are_flushed() {
  volatile float smallest = std::numeric_limits<float>::min(), half = 0.5f;
  const volatile float product = smallest * half;
  return product == 0.0f;
}

bool are_taken_for_zero() {
  volatile float subnormal = std::numeric_limits<float>::denorm_min(), large = 1e30f;
  const volatile float product = subnormal * large;
  return product == 0.0f;
}

#if defined(__x86_64__) || defined(__aarch64__)

TEST(FlushSubnormals, LastsAsLongAsTheObject) {
  ASSERT_FALSE(are_flushed());
  {
    const FlushSubnormals flush;
    EXPECT_TRUE(are_flushed());
    EXPECT_TRUE(are_taken_for_zero());
    {
      const FlushSubnormals again;
      EXPECT_TRUE(are_flushed());
    }
    EXPECT_TRUE(are_flushed());
  }
  EXPECT_FALSE(are_flushed());
  EXPECT_FALSE(are_taken_for_zero());
}

// The factorisation's fronts are tasks that run loops of their own and go on computing after them.
TEST(FlushSubnormals, HoldsInATaskAfterALoopWithin) {
  const int before = thread_count();
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    TaskTree tree({2, 2, 4, 4, -1});
    std::vector<int> held(5, 0);
    std::vector<std::vector<int>> held_in_loop(5, std::vector<int>(1000, 0));
    run_upwards(tree, [&](Index t) {
      const FlushSubnormals flush;
      parallel_for(1000, 10, [&](Index begin, Index end) {
        const FlushSubnormals flush_here;
        for (Index i = begin; i < end; ++i) held_in_loop[t][i] = are_flushed();
      });
      held[t] = are_flushed();
    });
    EXPECT_EQ(held, std::vector<int>(5, 1)) << threads << " threads";
    for (const auto& of : held_in_loop)
      EXPECT_EQ(of, std::vector<int>(1000, 1)) << threads << " threads";
    EXPECT_FALSE(are_flushed()) << threads << " threads";
  }
  set_thread_count(before);
}

#endif

}  // namespace
}  // namespace taut::test
