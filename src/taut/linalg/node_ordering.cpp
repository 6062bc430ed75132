#include "taut/linalg/node_ordering.h"

#include <metis.h>

#include <mutex>
#include <new>
#include <numeric>

namespace taut {

std::vector<Index> nested_dissection(const NodeGraph& graph, int imbalance) {
  std::vector<Index> order(static_cast<std::size_t>(graph.nodes()));
  std::iota(order.begin(), order.end(), 0);
  if (graph.neighbour.empty()) return order;

  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_UFACTOR] = imbalance;
  idx_t nodes = graph.nodes();
  std::vector<idx_t> start(graph.start.begin(), graph.start.end()),
      neighbour(graph.neighbour.begin(), graph.neighbour.end());
  std::vector<idx_t> from_place(order.size()), to_place(order.size());
  const int result = METIS_NodeND(&nodes, start.data(), neighbour.data(), nullptr, options,
                                  from_place.data(), to_place.data());
  if (result != METIS_OK) throw std::bad_alloc();  // the graph is well formed: there was no memory
  order.assign(from_place.begin(), from_place.end());
  return order;
}

}  // namespace taut
