#pragma once
// What contact with solids takes from one step to the next, and what a checkpoint keeps of it.
//
//   normal, friction   N: impulses over h, so that the next step may have another h
//   inverse_mass       1/kg: how readily friction slows the node (compliance over h)
//   wait               steps until a node that broke loose may stick again
//
// One entry a contact, ordered by node, then solid. What belongs to the node is the same in all of
// its entries. Restored, a run goes on to the same bits. restore throws InputError on a state that
// does not fit. docs/design/solid_contact.md

#include <array>
#include <cstdint>
#include <vector>

#include "taut/base/types.h"

namespace taut {

// Friction, inverse mass and the waits are the node's, the same for all its contacts.
struct ContactForce {
  double normal = 0.0;                  // N: lambda / h
  std::array<double, 3> friction = {};  // N, of a sliding node
  double inverse_mass = 0.0;            // 1/kg: how readily friction slows the node; 0 if not known
  bool operator==(const ContactForce&) const = default;
};
struct ContactStick {
  std::uint8_t sticks = 0;        // 1: the node sticks, 0: it slides
  std::uint8_t wait = 0;          // steps until a node that broke loose may stick again,
  std::uint8_t longest_wait = 0;  // and how long that was from the start
  bool operator==(const ContactStick&) const = default;
};

// Elements without padding, so that a checkpoint may store them as bytes.
struct ContactState {
  std::vector<Index> node;
  std::vector<Index> solid;
  std::vector<ContactStick> sticking;
  std::vector<ContactForce> normal_force;
  bool operator==(const ContactState&) const = default;
};

class ContactMemory {
 public:
  const ContactState& state() const { return state_; }
  // Of a run with so many nodes and solids.
  void restore(ContactState state, Index nodes, Index solids);

  void forget() { state_ = {}; }
  // In ascending order of node, then solid (asserted).
  void remember(Index node, Index solid, const ContactStick& stick, const ContactForce& force);

 private:
  ContactState state_;
};

}  // namespace taut
