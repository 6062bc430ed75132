#include "taut/contact/stick_slip.h"

#include <algorithm>

#include "taut/contact/impulse_split.h"

namespace taut {
namespace {

constexpr double still = 1e-12;  // m: slip in one step below which a node does not slide
// of a node's way, by which it may slip where it starts to stick at first touch
constexpr double riding_share = 1e-2;
constexpr int most_renewals = 3;  // of the impulse in one step
constexpr int longest_wait = 15;  // steps until a node that broke loose is held again

double total_hold(std::span<const ContactSlip> slips) {
  double hold = 0.0;
  for (const ContactSlip& contact : slips) hold += contact.hold;
  return hold;
}

// Does the node move with its solids, but for a small share of its way?
bool rides(std::span<const ContactSlip> slips, double way) {
  const double slack = std::max(still, riding_share * way);
  return std::ranges::all_of(
      slips, [&](const ContactSlip& contact) { return contact.slip.norm() <= slack; });
}

// All that the contacts can hold, each against its slip, to which what friction has taken from it
// (m) is added back.
Vec3 sliding_impulse(std::span<const ContactSlip> slips, const Vec3& taken) {
  Vec3 impulse = Vec3::Zero();
  for (const ContactSlip& contact : slips) {
    const Vec3 slip = contact.slip - taken;
    const double length = slip.norm();
    if (length > still) impulse -= contact.hold / length * slip;
  }
  return impulse;
}

}  // namespace

StickSlip::StickSlip(const ContactStick& stick, const ContactForce& force, double h)
    : sticks_(stick.sticks != 0),
      impulse_(h * Vec3(force.friction.data())),
      compliance_(h * force.inverse_mass),
      wait_(stick.wait),
      longest_wait_(stick.longest_wait) {}

void StickSlip::begin(std::span<const ContactSlip> slips, double way) {
  const double size = impulse_.norm();
  // The impulse of the step before was less than it could have been: it stops the node.
  if (size > 0.0 && size < (1.0 - friction_share) * total_hold(slips)) return;
  sticks_ = wait_ == 0 && rides(slips, way);
  impulse_ = sliding_impulse(slips, Vec3::Zero());
}

void StickSlip::begin_pass(double hold) {
  hold_ = hold;
  change_ = 0.0;
  turned_ = false;
}

bool StickSlip::may_renew() {
  if (renewals_ == most_renewals) return false;
  ++renewals_;
  return true;
}

void StickSlip::judge_stick(const Vec3& tangential, double negligible) {
  if (!may_renew()) return;
  const double needed = tangential.norm();
  if (needed <= hold_ + negligible) return;
  sticks_ = false;
  turned_ = broke_loose_ = true;
  change_ = needed - hold_;
  impulse_ = hold_ / needed * tangential;
  last_impulse_ = tangential;
  last_slip_ = Vec3::Zero();
}

void StickSlip::judge_slide(std::span<const ContactSlip> slips, std::size_t holder) {
  if (!may_renew()) return;
  const Vec3& slip = slips[holder].slip;
  learn_compliance(slip);
  const bool reversed = slip.dot(impulse_) > 0.0;
  last_impulse_ = impulse_;
  last_slip_ = slip;
  // Friction that drives the node instead of slowing it is too much; how much is not known before a
  // second pass.
  const bool unknown = compliance_ == 0.0 && reversed;
  const Vec3 next = unknown ? Vec3(0.5 * impulse_) : renewed(slips, holder);
  stoppable_ = reversed || next.norm() < (1.0 - friction_share) * hold_;
  change_ = (next - impulse_).norm();
  impulse_ = next;
}

void StickSlip::learn_compliance(const Vec3& slip) {
  if (!last_slip_) return;
  const Vec3 change = impulse_ - last_impulse_;
  const double size = change.squaredNorm();
  if (size <= friction_share * friction_share * hold_ * hold_) return;
  const double compliance = change.dot(slip - *last_slip_) / size;
  if (compliance > 0.0) compliance_ = compliance;
}

// Goes by the slip that would be there without friction. To go by the slip that is left would
// diverge for nodes close to rest.
Vec3 StickSlip::renewed(std::span<const ContactSlip> slips, std::size_t holder) const {
  const Vec3 taken = compliance_ * impulse_;
  const Vec3 sliding = sliding_impulse(slips, taken);
  if (compliance_ == 0.0) return sliding;
  const Vec3 stopping = (taken - slips[holder].slip) / compliance_;
  return stopping.squaredNorm() < sliding.squaredNorm() ? stopping : sliding;
}

void StickSlip::turn_to(std::span<const Vec3> normals) {
  impulse_ = tangential_part(normals, impulse_);
}

// Stiff cloth with slack springs pulls at its nodes irregularly, by more than friction holds: one
// that broke loose is left to slide, with friction that stops it, for 1, 3, 7, 15 steps before it
// is held again.
bool StickSlip::settle() {
  if (broke_loose_) {
    wait_ = longest_wait_ = std::min(2 * longest_wait_ + 1, longest_wait);
  } else if (sticks_) {
    longest_wait_ = 0;
  } else if (stoppable_ && wait_ > 0) {
    --wait_;
  } else if (stoppable_) {
    sticks_ = true;
    return true;
  }
  return false;
}

ContactStick StickSlip::stick() const {
  return {sticks_, static_cast<std::uint8_t>(wait_), static_cast<std::uint8_t>(longest_wait_)};
}

ContactForce StickSlip::force(double lambda, double h) const {
  const Vec3 friction = impulse_ / h;
  return {std::max(lambda, 0.0) / h, {friction.x(), friction.y(), friction.z()}, compliance_ / h};
}

}  // namespace taut
