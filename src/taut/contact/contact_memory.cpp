#include "taut/contact/contact_memory.h"

#include <cassert>
#include <string>
#include <tuple>
#include <utility>

#include "taut/base/error.h"

namespace taut {
namespace {

// Is entry k in its place after the one before?
bool ordered(const ContactState& state, std::size_t k) {
  return k == 0 ||
         std::tie(state.node[k - 1], state.solid[k - 1]) < std::tie(state.node[k], state.solid[k]);
}

}  // namespace

void ContactMemory::remember(Index node, Index solid, const ContactStick& stick,
                             const ContactForce& force) {
  state_.node.push_back(node);
  state_.solid.push_back(solid);
  state_.sticking.push_back(stick);
  state_.normal_force.push_back(force);
  assert(ordered(state_, state_.node.size() - 1));
}

void ContactMemory::restore(ContactState state, Index nodes, Index solids) {
  const std::size_t n = state.node.size();
  if (state.solid.size() != n || state.sticking.size() != n || state.normal_force.size() != n)
    throw InputError(
        "contact state: the lists have different lengths; the checkpoint is damaged, start from an "
        "earlier one");
  for (std::size_t k = 0; k < n; ++k) {
    const bool inside = state.node[k] >= 0 && state.node[k] < nodes && state.solid[k] >= 0 &&
                        state.solid[k] < solids;
    if (!inside || !ordered(state, k))
      throw InputError("contact state: entry " + std::to_string(k) + " (node " +
                       std::to_string(state.node[k]) + ", solid " + std::to_string(state.solid[k]) +
                       ") is out of range or out of order; expected nodes below " +
                       std::to_string(nodes) + " and solids below " + std::to_string(solids) +
                       ": the checkpoint belongs to another scene");
  }
  state_ = std::move(state);
}

}  // namespace taut
