// The dense kernels of every instruction set that this machine can run, and the plain ones, through
// a whole factorisation.

#include <gtest/gtest.h>

#include "linalg/random_matrix.h"
#include "taut/linalg/block_cholesky/numeric_factor.h"

namespace taut::test {
namespace {

template <class T>
class FrontKernelsOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(FrontKernelsOf, Precisions);

template <class T>
double solution_error(const BlockCsr& a, const FrontKernels<T>& kernels, Random& random) {
  AnalyzedGraph all = analyzed_graph(*a.pattern);
  std::vector<Index> condensed = condensed_nodes(all);
  CondensedGraph graph = condensed_graph(std::move(all), std::move(condensed));
  const SupernodeTree tree =
      make_supernode_tree(graph.rest.graph, nested_dissection(graph.rest.graph), graph.rest.weight);
  const std::vector<Index> condensed_at = assign_condensed(graph, tree);
  NumericFactor<T> factor(tree, graph, condensed_at, kernels);
  std::vector<Index> start;
  for (const Index i : factor.layout().node) start.push_back(a.pattern->dof_start[i]);
  const std::vector<double> b = random.vector(a.dofs());
  std::vector<double> x(b.size());
  EXPECT_TRUE(factor.factorize({a, {}, true}, start, {}).ok());
  factor.solve_forward({start}, b.data());
  factor.solve_backward({start}, 0.0, x.data());
  return relative_difference(x, dense(a).llt().solve(as_eigen(b)));
}

// From fronts of one column to fronts of several panels (more than 120 columns) with updates of
// many slabs.
TYPED_TEST(FrontKernelsOf, FactoriseAndSolve) {
  const auto runnable = runnable_front_kernels<TypeParam>();
  EXPECT_STREQ(runnable.back()->instruction_set, "plain");
  EXPECT_EQ(&front_kernels<TypeParam>(), runnable.front());
  for (const auto* kernels : runnable) {
    Random random(1);
    for (const Index nodes : {1, 3, 30, 300}) {
      const BlockCsr a =
          random_spd(random, make_pattern(random_graph(random, nodes, 8, 200), 3), 1e-2);
      EXPECT_LT(solution_error(a, *kernels, random), sizeof(TypeParam) == 4 ? 3e-5 : 1e-11)
          << kernels->instruction_set << ", " << nodes;
    }
  }
}

}  // namespace
}  // namespace taut::test
