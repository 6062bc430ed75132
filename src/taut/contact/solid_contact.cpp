#include "taut/contact/solid_contact.h"

#include <algorithm>
#include <cmath>

#include "taut/base/parallel.h"

namespace taut {
namespace {

constexpr double rounding_share = 1e-9;  // of the largest impulse: a pull below it is rounding
// from here on friction stays as it is, and only the normals go on
constexpr int friction_passes = 4;
constexpr Index node_grain = 4096, contact_grain = 256;

}  // namespace

SolidContact::SolidContact(std::vector<Solid> solids, Index nodes, ContactOptions options,
                           std::vector<std::vector<std::uint8_t>> meets)
    : set_(SolidObstacles(std::move(solids), nodes, options.touch_tolerance, std::move(meets))),
      max_passes_(options.max_passes) {}

// ---- one step

void SolidContact::begin_step(double t, double h, std::span<const Vec3> x,
                              std::span<const Vec3> x_predicted, const ConstraintSet& pins) {
  h_ = h;
  counts_ = {};
  counts_.added = set_.begin_step(t, h, x, x_predicted, pins, memory_.state());
  set_.renew_planes(x_predicted);
  start_friction(x_predicted);
  fill_impulses();
}

void SolidContact::constrain(ConstraintSet& constraints) const { set_.constrain(constraints); }

bool SolidContact::update(std::span<const Vec3> x_end, std::span<const Vec3> constraint_impulse) {
  ++counts_.passes;
  const std::span<TouchedNode> touched = set_.touched();
  double largest = 0.0;
  for (const TouchedNode& node : touched)
    largest = std::max(largest, constraint_impulse[node.node].squaredNorm());
  const double negligible = rounding_share * std::sqrt(largest);
  parallel_for(static_cast<Index>(touched.size()), contact_grain, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k)
      judge(touched[k], x_end[touched[k].node], constraint_impulse[touched[k].node], negligible);
  });

  double hold = 0.0, change = 0.0;
  for (const TouchedNode& node : touched) {
    hold += node.friction.hold();
    change += node.friction.change();
    counts_.stick_to_slide += node.friction.turned();
  }
  const ContactSet::Change dropped = set_.drop_released();
  const ContactSet::Change added = set_.add_inside(x_end);
  counts_.released += dropped.contacts;
  counts_.added += added.contacts;
  set_.renew_planes(x_end);
  start_friction(x_end);
  const bool floats = set_.ask_for_floating();
  fill_impulses();
  const bool normals_changed = dropped.matters || added.matters || floats;
  const bool friction_changed = change > friction_share * hold;
  return (normals_changed || friction_changed) && counts_.passes < max_passes_;
}

Index SolidContact::finish(std::span<Vec3> x_end) {
  move_out(x_end);
  keep();
  return counts_.moved;
}

Index SolidContact::move_out(std::span<Vec3> x_end) {
  std::vector<std::optional<double>> depth(static_cast<std::size_t>(nodes()));
  parallel_for(nodes(), node_grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      if (set_.free_of_pins(i)) depth[i] = obstacles().move_out(i, x_end[i]);
  });
  for (const std::optional<double>& moved : depth) {
    counts_.moved += moved.has_value();
    counts_.deepest = std::max(counts_.deepest, moved.value_or(0.0));
  }
  return counts_.moved;
}

void SolidContact::keep() {
  memory_.forget();
  for (TouchedNode& touched : set_.touched()) {
    counts_.slide_to_stick += touched.friction.settle();
    for (const Contact& contact : set_.of(touched))
      memory_.remember(contact.node, contact.solid, touched.friction.stick(),
                       touched.friction.force(contact.lambda, h_));
  }
}

// ---- friction

// Of nodes new to the set. Those of the step before go on.
void SolidContact::start_friction(std::span<const Vec3> x_end) {
  for (TouchedNode& touched : set_.touched()) {
    if (!std::exchange(touched.fresh, false) || touched.friction.sticks() ||
        !set_.has_friction(touched))
      continue;
    const Vec3& x1 = x_end[touched.node];
    const double way = (x1 - obstacles().start(touched.node)).norm();
    touched.friction.begin(set_.slips(touched, x1), way);
    if (touched.friction.sticks()) set_.renew_planes(touched, x1);
  }
}

void SolidContact::judge(TouchedNode& touched, const Vec3& x_end, const Vec3& impulse,
                         double negligible) {
  const ContactSet::Share share = set_.split(touched, impulse, negligible);
  StickSlip& friction = touched.friction;
  friction.begin_pass(set_.hold(touched));
  if (share.pulls || counts_.passes > friction_passes || !set_.has_friction(touched)) return;
  if (friction.sticks())
    friction.judge_stick(share.tangential, negligible);
  else
    friction.judge_slide(set_.slips(touched, x_end), set_.holder(touched));
}

void SolidContact::fill_impulses() {
  impulses_.clear();
  const std::span<const TouchedNode> touched = set_.touched();
  const auto rubs = [](const TouchedNode& node) { return !node.friction.impulse().isZero(0.0); };
  if (std::ranges::none_of(touched, rubs)) return;
  impulses_.assign(static_cast<std::size_t>(nodes()), Vec3::Zero());
  for (const TouchedNode& node : touched) impulses_[node.node] = node.friction.impulse();
}

int SolidContact::sticking() const {
  return static_cast<int>(std::ranges::count_if(
      set_.touched(), [](const TouchedNode& node) { return node.friction.sticks(); }));
}

// ---- between steps, and for others

void SolidContact::restore(ContactState state) {
  memory_.restore(std::move(state), nodes(), static_cast<Index>(solids().size()));
}

void SolidContact::set_solid(std::size_t k, const Solid& solid) { set_.set_motion(k, solid); }

std::optional<Obstacle> SolidContact::obstacle(Index node, const Vec3& x_end) const {
  return obstacles().obstacle(node, x_end);
}

std::vector<std::pair<Index, Obstacle>> SolidContact::touched(std::span<const Vec3> x_end) const {
  std::vector<std::pair<Index, Obstacle>> touched;
  for (const Contact& contact : set_.contacts())
    touched.emplace_back(contact.node,
                         obstacles().obstacle(contact.node, contact.solid, x_end[contact.node]));
  return touched;
}

}  // namespace taut
