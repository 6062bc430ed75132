// Whole solves give the same bits for any number of threads: long strips of cloth-like coupling, so
// that all loops are split and factors stay small.

#include <gtest/gtest.h>

#include "solve/constrained_case.h"
#include "taut/base/parallel.h"

namespace taut::test {
namespace {

class Determinism : public testing::TestWithParam<std::string> {
 protected:
  ~Determinism() override { set_thread_count(before_); }

 private:
  const int before_ = thread_count();
};

INSTANTIATE_TEST_SUITE_P(All, Determinism, testing::ValuesIn(solvers_to_test()),
                         [](const auto& solver) { return test_name(solver.param); });

const ConstrainedCase& strip() {
  static const ConstrainedCase built = [] {
    Random random(1);
    ConstrainedCase c;
    constexpr Index nodes = 6'000;
    c.a = random_spd(random, make_pattern(random_graph(random, nodes, 2, 3), 3), 0.05);
    c.b = random.vector(3 * nodes), c.z = random.vector(3 * nodes),
    c.guess = random.vector(3 * nodes);
    c.constraints.reset(nodes);
    for (Index i = 0; i < nodes; i += 7) {
      if (i % 3 == 0)
        c.constraints.fix(i, Vec3::Zero());
      else
        c.constraints.constrain(i, random.direction(), 0.0);
    }
    return c;
  }();
  return built;
}

TEST_P(Determinism, SameBitsForAnyNumberOfThreads) {
  const ConstrainedCase& c = strip();
  for (const std::string reordering : {"vectors", "matrix"}) {
    // the only one that has two
    if (reordering == "matrix" && !GetParam().starts_with("core_pcg")) continue;
    SolverOptions options = solver_options(GetParam(), 1e-5);
    options.reordering = reordering;
    std::vector<double> expected;
    for (const int threads : {1, 2, 3, 4}) {
      set_thread_count(threads);
      std::vector<double> x(c.b.size());
      const SolveSummary summary = make_solver(options)->solve(c.system(), x);
      ASSERT_TRUE(summary.status.ok()) << summary.status.message;
      x.push_back(summary.iterations), x.push_back(summary.relative_residual),
          x.push_back(summary.stop_value);
      if (threads == 1) expected = x;
      EXPECT_EQ(x, expected) << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace taut::test
