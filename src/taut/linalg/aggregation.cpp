#include "taut/linalg/aggregation.h"

namespace taut {

Aggregation aggregate(const WeightedGraph& graph) {
  const Index n = graph.nodes();
  Aggregation result;
  std::vector<Index>& group = result.group;
  group.assign(static_cast<std::size_t>(n), -1);
  const auto neighbours = [&](Index i, auto visit) {
    for (Index k = graph.start[i]; k < graph.start[i + 1]; ++k)
      visit(graph.neighbour[k], graph.weight[k]);
  };
  for (Index i = 0; i < n; ++i) {
    bool free = group[i] < 0;
    neighbours(i, [&](Index j, double) { free = free && group[j] < 0; });
    if (!free) continue;
    neighbours(i, [&](Index j, double) { group[j] = result.groups; });
    group[i] = result.groups++;
  }
  const std::vector<Index> founded = group;
  for (Index i = 0; i < n; ++i) {
    double strongest = 0.0;
    if (founded[i] >= 0) continue;
    neighbours(i, [&](Index j, double weight) {
      if (founded[j] >= 0 && weight > strongest) strongest = weight, group[i] = founded[j];
    });
  }
  for (Index i = 0; i < n; ++i) {
    if (group[i] >= 0) continue;
    neighbours(i, [&](Index j, double) {
      if (group[j] < 0) group[j] = result.groups;
    });
    group[i] = result.groups++;
  }
  return result;
}

}  // namespace taut
