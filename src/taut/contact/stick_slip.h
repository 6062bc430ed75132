#pragma once
// Coulomb friction of one node on the solids that it touches, as a function of its history. Knows
// no solids, planes or other nodes.
//
//   hold        N s: sum of mu_k lambda_k over the contacts, the most that friction can do
//   slip        m: motion relative to a solid, in the directions that all contacts leave free
//   impulse     N s: friction of a sliding node: hold against the slip, or what stops it if that
//               is less
//   compliance  m/(N s): slip that an impulse takes away, learnt from two passes; 0 while unknown
//
// begin at the first touch in a step; after a pass begin_pass, then judge_stick or judge_slide,
// which change something at most 3 times a step, so that no cycle lasts; settle at the step's end.
// docs/mathematics.md, 3.6; docs/design/solid_contact.md

#include <optional>
#include <span>

#include "taut/contact/contact_memory.h"

namespace taut {

// Share of what can be held by which friction may be out of date.
inline constexpr double friction_share = 5e-2;

// One contact as friction sees it.
struct ContactSlip {
  double hold = 0.0;  // N s: mu lambda, at least 0
  Vec3 slip = Vec3::Zero();
};

class StickSlip {
 public:
  StickSlip() = default;  // slides, nothing known
  // As the step before left it; h: s, of this step.
  StickSlip(const ContactStick& stick, const ContactForce& force, double h);

  bool sticks() const { return sticks_; }
  const Vec3& impulse() const { return impulse_; }
  // Of the last pass:
  double hold() const { return hold_; }
  double change() const { return change_; }  // N s: of the impulse
  bool turned() const { return turned_; }    // from stick to slide

  // A sliding node that is new in this step, or was there in the step before: it sticks if it
  // hardly slips on its way (m) and need not wait, and slides else.
  void begin(std::span<const ContactSlip> slips, double way);

  void begin_pass(double hold);
  // Of a sticking node. tangential: N s, what holds it beside the normals; below `negligible` is
  // rounding. Turns to slide where that is more than the hold.
  void judge_stick(const Vec3& tangential, double negligible);
  // Of a sliding node: renews the impulse. holder: the contact that can hold most.
  void judge_slide(std::span<const ContactSlip> slips, std::size_t holder);
  // The contacts' normals have changed.
  void turn_to(std::span<const Vec3> normals);
  // No contact with friction is left.
  void lose_hold() { sticks_ = false; }

  // Stick or slide in the next step. True if a sliding node sticks from then on.
  bool settle();

  ContactStick stick() const;
  ContactForce force(double lambda, double h) const;

 private:
  bool may_renew();
  void learn_compliance(const Vec3& slip);
  Vec3 renewed(std::span<const ContactSlip> slips, std::size_t holder) const;

  bool sticks_ = false;
  Vec3 impulse_ = Vec3::Zero();
  double compliance_ = 0.0;
  int wait_ = 0;          // steps until it may stick
  int longest_wait_ = 0;  // the last such wait, from its start

  // In this step:
  double hold_ = 0.0;
  double change_ = 0.0;
  bool turned_ = false;
  bool broke_loose_ = false;
  bool stoppable_ = false;              // slides, but friction would stop it
  int renewals_ = 0;                    // of the impulse
  Vec3 last_impulse_ = Vec3::Zero();    // of the pass before
  std::optional<Vec3> last_slip_ = {};  // m: of the pass before
};

}  // namespace taut
