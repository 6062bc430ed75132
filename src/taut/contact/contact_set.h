#pragma once
// Which nodes touch which solids in this step, and the planes on which they end.
//
//   contact    a pair (node, solid): n·(x_end - x_start) = distance, n the solid's outward normal
//   anchor     the solid's material point at first touch; it ends at `target`
//   lambda     N s: the contact's share of the node's constraint impulse, >= 0 where it pushes
//   slip       m: x_end - target, in the directions that pins and the node's normals leave free
//   fresh      added since the last add_inside
//
// begin_step finds the contacts, renew_planes gives them planes. A pass: split for each node, then
// drop_released, add_inside, renew_planes, once. Whether a node sticks is for its StickSlip to say;
// the set carries it along. Order: node, then solid, the same for any number of threads. Functions
// of one node may run in parallel for different nodes. docs/design/solid_contact.md

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "taut/constraint/constraint_set.h"
#include "taut/contact/contact_memory.h"
#include "taut/contact/solid_obstacles.h"
#include "taut/contact/stick_slip.h"

namespace taut {

struct Contact {
  Index node = 0;
  Index solid = 0;
  Vec3 anchor = Vec3::Zero();  // local, on the surface
  Vec3 target = Vec3::Zero();  // m, world: where the anchor ends
  Vec3 normal = Vec3::UnitZ();
  double distance = 0.0;  // m
  double lambda = 0.0;    // N s
  Index kept = -1;        // its entry in the state of the step before
  bool fresh = true;
  bool stays = false;  // let go often enough: not again in this step
  bool released = false;
};

// A node in contact, and where its contacts begin in the list of all.
struct TouchedNode {
  Index node = 0;
  Index first = 0;
  Index count = 0;
  bool fresh = true;    // its friction has not begun yet
  bool floats = false;  // off the surface: its planes must be made anew
  int renewals = 0;     // passes asked for because of that, in this step
  StickSlip friction;
};

class ContactSet {
 public:
  explicit ContactSet(SolidObstacles obstacles);

  void set_motion(std::size_t k, const Solid& solid) { obstacles_.set_motion(k, solid); }
  // As SolidContact::begin_step, with the contacts of the step before. Returns how many were added.
  int begin_step(double t, double h, std::span<const Vec3> x, std::span<const Vec3> x_predicted,
                 const ConstraintSet& pins, const ContactState& before);

  // What a pass changed. What does not matter can wait for the next step.
  struct Change {
    int contacts = 0;
    bool matters = false;
  };
  // Splits a node's constraint impulse, N s, among its contacts, and marks the one that pulls most,
  // by more than `negligible`, to be released.
  struct Share {
    Vec3 tangential = Vec3::Zero();
    bool pulls = false;
  };
  Share split(const TouchedNode& touched, const Vec3& impulse, double negligible);
  Change drop_released();
  // Contacts of nodes that would end inside.
  Change add_inside(std::span<const Vec3> x_end);
  // For nodes that end at x_end; one that sticks ends with its holder's target.
  void renew_planes(std::span<const Vec3> x_end);
  void renew_planes(TouchedNode& touched, const Vec3& x_end);
  // Must a pass follow because nodes float? A node asks for two a step.
  bool ask_for_floating();
  void constrain(ConstraintSet& constraints) const;

  std::span<const Contact> contacts() const { return contacts_; }
  std::span<TouchedNode> touched() { return touched_; }
  std::span<const TouchedNode> touched() const { return touched_; }
  std::span<const Contact> of(const TouchedNode& touched) const {
    return {contacts_.data() + touched.first, static_cast<std::size_t>(touched.count)};
  }
  const SolidObstacles& obstacles() const { return obstacles_; }
  bool free_of_pins(Index node) const { return pin_ndof_[node] == 3; }

  bool has_friction(const TouchedNode& touched) const;
  double hold(const TouchedNode& touched) const;  // N s: sum mu lambda
  // Of its contacts, the one that can hold most.
  std::size_t holder(const TouchedNode& touched) const;
  // One a contact of the node; valid until contacts come or go.
  std::span<const ContactSlip> slips(const TouchedNode& touched, const Vec3& x_end);

 private:
  struct Normals;

  std::span<Contact> writable(const TouchedNode& touched) {
    return {contacts_.data() + touched.first, static_cast<std::size_t>(touched.count)};
  }
  const SolidStep& step_of(const Contact& contact) const { return obstacles_.step(contact.solid); }
  double hold(const Contact& contact) const;
  Vec3 free_part(Index node, const Vec3& a) const;
  Normals normals_of(const TouchedNode& touched) const;

  void read_pins(const ConstraintSet& pins);
  Contact contact_at(Index node, Index solid, const Vec3& x_end, double touch_tolerance) const;
  void keep_contacts(double h, std::span<const Vec3> x_predicted, const ContactState& before);
  template <class Meets>
  int add_met(std::span<const Vec3> x_end, const Meets& meets);
  int add_predicted(std::span<const Vec3> x_predicted);
  void group();
  void recall_friction(double h, const ContactState& before);

  SolidObstacles obstacles_;
  std::vector<std::int8_t> pin_ndof_;
  std::vector<std::pair<Index, Mat3>> partial_pins_;  // S of nodes with ndof 1 or 2, by node
  std::vector<Contact> contacts_;                     // by node, then solid
  std::vector<TouchedNode> touched_;                  // by node
  std::map<std::pair<Index, Index>, int> releases_;   // (node, solid) -> how often in this step
  std::vector<ContactSlip> slips_;                    // one a contact
  std::vector<std::uint8_t> met_;                     // one a node: scratch of add_met
};

}  // namespace taut
