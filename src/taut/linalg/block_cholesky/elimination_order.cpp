#include "taut/linalg/block_cholesky/elimination_order.h"

#include <limits>

#include "taut/linalg/block_cholesky/elimination_tree.h"

namespace taut {

namespace {

// Thousandths. Beyond 600 METIS may return orders that are no dissection any more.
constexpr int imbalances[] = {default_imbalance, 400, 600};

double factor_flops(const NodeGraph& graph, std::span<const Index> order,
                    std::span<const Index> weight) {
  std::vector<Index> ordered_weight;
  for (const Index i : order) ordered_weight.push_back(weight[i]);
  const NodeGraph ordered = renumbered(graph, order);
  const std::vector<Index> parent = elimination_tree(ordered);
  const std::vector<Index> count =
      column_counts(ordered, parent, postorder(parent), ordered_weight);
  double flops = 0.0;
  for (std::size_t j = 0; j < count.size(); ++j)
    for (Index r = 0; r < ordered_weight[j]; ++r)
      flops += static_cast<double>(count[j] - r) * (count[j] - r);
  return flops;
}

}  // namespace

std::vector<Index> elimination_order(const NodeGraph& graph, std::span<const Index> weight) {
  std::vector<Index> best;
  double fewest = std::numeric_limits<double>::infinity();
  for (const int imbalance : imbalances) {
    std::vector<Index> order = nested_dissection(graph, imbalance);
    if (const double flops = factor_flops(graph, order, weight); flops < fewest) {
      fewest = flops;
      best = std::move(order);
    }
  }
  return best;
}

}  // namespace taut
