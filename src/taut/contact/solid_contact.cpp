#include "taut/contact/solid_contact.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <tuple>
#include <utility>

#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/contact/impulse_split.h"

namespace taut {
namespace {

constexpr double rounding_share = 1e-9;  // of the largest impulse: a pull below it is rounding
constexpr double pull_share = 1e-2;      // of all pushes: pulls that may wait until the next step
// of what all nodes can hold: friction that may be out of date
constexpr double friction_share = 5e-2;
// m: relative motion in one step below which a node does not slide
constexpr double still = 1e-12;
// from here on friction stays as it is, and only the normals go on
constexpr int friction_passes = 4;
constexpr int friction_updates = 3;  // of one node in one step
constexpr int longest_wait = 15;     // steps until a node that broke loose is held again
// of a node's way, by which it may slip where it starts to stick at first touch
constexpr double riding_share = 1e-2;
// passes asked for because a node floats over a curved surface or an edge, in one step
constexpr int most_renewals = 2;
constexpr int most_releases = 2;          // of one contact in one step
constexpr std::size_t most_normals = 16;  // of one node; any further ones depend on them
constexpr Index node_grain = 4096, contact_grain = 256;

}  // namespace

struct SolidContact::Normals {
  std::array<Vec3, most_normals> n;
  std::size_t count = 0;
  std::span<const Vec3> span() const { return {n.data(), count}; }
};

SolidContact::SolidContact(std::vector<Solid> solids, Index nodes, ContactOptions options,
                           std::vector<std::vector<std::uint8_t>> meets)
    : solids_(std::move(solids)),
      meets_(std::move(meets)),
      options_(std::move(options)),
      nodes_(nodes),
      met_(static_cast<std::size_t>(nodes)) {
  meets_.resize(solids_.size());
}

// ---- one step

void SolidContact::begin_step(double t, double h, std::span<const Vec3> x,
                              std::span<const Vec3> x_predicted, const ConstraintSet& pins) {
  assert(std::ssize(x) == nodes_ && std::ssize(x_predicted) == nodes_ && pins.nodes() == nodes_ &&
         h > 0.0);
  h_ = h;
  start_.assign(x.begin(), x.end());
  pin_ndof_.assign(pins.ndofs().begin(), pins.ndofs().end());
  partial_pins_.clear();
  for (Index i = 0; i < nodes_; ++i)
    if (pins.ndof(i) == 1 || pins.ndof(i) == 2) partial_pins_.emplace_back(i, pins.projection(i));
  steps_.clear();
  for (const Solid& solid : solids_) steps_.emplace_back(solid, t, h);
  counts_ = {};
  releases_.clear();
  touched_.clear();
  keep_contacts(h, x_predicted);
  counts_.added = add_predicted(x_predicted);
  group();
  renew_planes(x_predicted);
  start_fresh(x_predicted);
  fill_impulses();
}

void SolidContact::constrain(ConstraintSet& constraints) const {
  for (const TouchedNode& touched : touched_) {
    const Index i = touched.node;
    for (const Contact& contact : of(touched))
      constraints.constrain(i, contact.normal, contact.distance);
    if (!touched.sticking) continue;
    const Vec3 ride = holder(touched).target - start_[i];
    constraints.fix(i, constraints.displacement(i) + constraints.free_part(i, ride));
  }
}

std::span<const Vec3> SolidContact::impulses() const { return impulses_; }

bool SolidContact::update(std::span<const Vec3> x_end, std::span<const Vec3> constraint_impulse) {
  ++counts_.passes;
  double largest = 0.0;
  for (const TouchedNode& touched : touched_)
    largest = std::max(largest, constraint_impulse[touched.node].squaredNorm());
  const double negligible = rounding_share * std::sqrt(largest);
  parallel_for(static_cast<Index>(touched_.size()), contact_grain, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k)
      judge(touched_[k], x_end[touched_[k].node], constraint_impulse[touched_[k].node], negligible);
  });

  double hold = 0.0, change = 0.0;
  for (const TouchedNode& touched : touched_) {
    hold += touched.hold;
    change += touched.change;
    counts_.stick_to_slide += touched.turned;
  }
  const bool pulls = drop_released();
  const bool inside = add_inside(x_end);
  renew_planes(x_end);
  start_fresh(x_end);
  bool floats = false;
  for (TouchedNode& touched : touched_)
    floats |= touched.floats && ++touched.renewals <= most_renewals;
  fill_impulses();
  const bool normals_changed = pulls || inside || floats;
  const bool friction_changed = change > friction_share * hold;
  return (normals_changed || friction_changed) && counts_.passes < options_.max_passes;
}

Index SolidContact::finish(std::span<Vec3> x_end) {
  move_out(x_end);
  keep();
  return counts_.moved;
}

Index SolidContact::move_out(std::span<Vec3> x_end) {
  std::vector<double> depth(static_cast<std::size_t>(nodes_), 0.0);
  parallel_for(nodes_, node_grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) met_[i] = move_out(i, x_end[i], depth[i]);
  });
  for (Index i = 0; i < nodes_; ++i) {
    counts_.moved += met_[i];
    counts_.deepest = std::max(counts_.deepest, depth[i]);
  }
  return counts_.moved;
}

void SolidContact::keep() {
  for (TouchedNode& touched : touched_) settle(touched);
  remember();
}

// Stick and slide for the next step. Stiff cloth with slack springs pulls at its nodes irregularly,
// by more than friction holds: one that broke loose is left to slide, with friction that stops it,
// for 1, 3, 7, 15 steps before it is held again.
void SolidContact::settle(TouchedNode& touched) {
  if (touched.turned_loose) {
    touched.wait = touched.longest = std::min(2 * touched.longest + 1, longest_wait);
  } else if (touched.sticking) {
    touched.longest = 0;
  } else if (touched.holds && touched.wait > 0) {
    --touched.wait;
  } else if (touched.holds) {
    touched.sticking = true;
    ++counts_.slide_to_stick;
  }
}

bool SolidContact::move_out(Index node, Vec3& x_end, double& depth) const {
  if (pin_ndof_[node] != 3) return false;
  bool moved = false;
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    if (!may_meet(s, node) || !steps_[s].meets(start_[node], x_end, -depth_tolerance(steps_[s])))
      continue;
    const Vec3 anchor = steps_[s].anchor(start_[node], x_end, options_.touch_tolerance);
    const LandingPlane plane = steps_[s].landing(x_end, anchor);
    depth = std::max(depth, -plane.gap);
    x_end -= plane.gap * plane.normal;
    moved = true;
  }
  return moved;
}

// ---- which contacts there are

SolidContact::Contact SolidContact::contact_at(Index node, Index solid, const Vec3& x_end,
                                               double touch_tolerance) const {
  Contact contact;
  contact.node = node;
  contact.solid = solid;
  contact.anchor = step_of(contact).anchor(start_[node], x_end, touch_tolerance);
  contact.target = step_of(contact).carried(contact.anchor);
  return contact;
}

void SolidContact::keep_contacts(double h, std::span<const Vec3> x_predicted) {
  contacts_.clear();
  for (std::size_t k = 0; k < kept_.node.size(); ++k) {
    const Index node = kept_.node[k], solid = kept_.solid[k];
    const SolidStep& step = steps_[static_cast<std::size_t>(solid)];
    // A node left floating over a curved surface is still in contact; one that something else has
    // moved away is not.
    const double tolerance = std::max(options_.touch_tolerance, 2.0 * step.floating_tolerance());
    if (pin_ndof_[node] == 0 || step.start_gap(start_[node]) > tolerance) continue;
    Contact& contact =
        contacts_.emplace_back(contact_at(node, solid, x_predicted[node], tolerance));
    contact.kept = static_cast<Index>(k);
    contact.lambda = h * kept_.normal_force[k].normal;
  }
}

template <class Meets>
int SolidContact::add_met(std::span<const Vec3> x_end, const Meets& meets) {
  constexpr auto order = [](const Contact& a, const Contact& b) {
    return std::tie(a.node, a.solid) < std::tie(b.node, b.solid);
  };
  const std::size_t before = contacts_.size();
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    parallel_for(nodes_, node_grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        met_[i] = pin_ndof_[i] != 0 && may_meet(s, i) && meets(steps_[s], start_[i], x_end[i]);
    });
    Contact wanted;
    wanted.solid = static_cast<Index>(s);
    for (Index i = 0; i < nodes_; ++i) {
      if (!met_[i]) continue;
      wanted.node = i;
      if (std::binary_search(contacts_.begin(),
                             contacts_.begin() + static_cast<std::ptrdiff_t>(before), wanted,
                             order))
        continue;
      contacts_.push_back(contact_at(i, wanted.solid, x_end[i], options_.touch_tolerance));
      const auto released = releases_.find({i, wanted.solid});
      contacts_.back().stays = released != releases_.end() && released->second >= most_releases;
    }
  }
  std::sort(contacts_.begin() + static_cast<std::ptrdiff_t>(before), contacts_.end(), order);
  std::inplace_merge(contacts_.begin(), contacts_.begin() + static_cast<std::ptrdiff_t>(before),
                     contacts_.end(), order);
  return static_cast<int>(contacts_.size() - before);
}

int SolidContact::add_predicted(std::span<const Vec3> x_predicted) {
  const double touch = options_.touch_tolerance;
  return add_met(x_predicted, [&](const SolidStep& step, const Vec3& x0, const Vec3& x1) {
    // The second line: a node that lies on a curved surface and moves along it, straight on as far
    // as is known yet.
    return step.meets(x0, x1, touch) ||
           (step.meets(x0, x1, depth_tolerance(step)) && step.start_gap(x0) <= touch);
  });
}

bool SolidContact::add_inside(std::span<const Vec3> x_end) {
  for (Contact& contact : contacts_) contact.fresh = false;
  const double touch = options_.touch_tolerance;
  const int added = add_met(x_end, [&](const SolidStep& step, const Vec3& x0, const Vec3& x1) {
    return step.meets(x0, x1, -touch);
  });
  counts_.added += added;
  if (added > 0) group();
  return std::ranges::any_of(contacts_, [&](const Contact& contact) {
    // What is barely inside can wait: it is in the set from the next step on.
    const SolidStep& step = step_of(contact);
    return contact.fresh &&
           step.meets(start_[contact.node], x_end[contact.node], -depth_tolerance(step));
  });
}

bool SolidContact::drop_released() {
  double pull = 0.0, push = 0.0;
  for (const Contact& contact : contacts_) {
    push += std::max(contact.lambda, 0.0);
    if (!contact.released) continue;
    pull -= contact.lambda;
    ++counts_.released;
    ++releases_[{contact.node, contact.solid}];
  }
  if (pull > 0.0) {
    std::erase_if(contacts_, [](const Contact& contact) { return contact.released; });
    group();
  }
  return pull > pull_share * push;
}

void SolidContact::group() {
  std::vector<TouchedNode> grouped;
  auto old = touched_.begin();
  for (Index first = 0; first < std::ssize(contacts_);) {
    TouchedNode touched;
    const Index node = contacts_[first].node;
    while (old != touched_.end() && old->node < node) ++old;
    const bool known = old != touched_.end() && old->node == node;
    if (known) touched = *old;
    touched.node = node;
    touched.first = first;
    touched.count = 0;
    Index kept = -1;
    for (; first < std::ssize(contacts_) && contacts_[first].node == node; ++first, ++touched.count)
      kept = std::max(kept, contacts_[first].kept);
    touched.fresh = !known;
    if (!known && kept >= 0) recall(touched, static_cast<std::size_t>(kept));
    touched.sticking = touched.sticking && has_friction(touched);
    grouped.push_back(touched);
  }
  touched_ = std::move(grouped);
}

void SolidContact::recall(TouchedNode& touched, std::size_t kept) const {
  const ContactStick& stick = kept_.sticking[kept];
  const ContactForce& force = kept_.normal_force[kept];
  touched.sticking = stick.sticks != 0;
  touched.wait = stick.wait;
  touched.longest = stick.longest_wait;
  touched.friction = h_ * Vec3(force.friction.data());
  touched.compliance = h_ * force.inverse_mass;
}

// ---- normals and planes

double SolidContact::depth_tolerance(const SolidStep& step) const {
  return std::max(options_.touch_tolerance, step.floating_tolerance());
}

bool SolidContact::has_friction(const TouchedNode& touched) const {
  return std::ranges::any_of(
      of(touched), [&](const Contact& contact) { return step_of(contact).friction() > 0.0; });
}

// The contact whose solid a sticking node rides with: the one that can hold most.
const SolidContact::Contact& SolidContact::holder(const TouchedNode& touched) const {
  const auto strength = [&](const Contact& c) {
    return std::pair(step_of(c).friction() * std::max(c.lambda, 0.0), step_of(c).friction());
  };
  const auto contacts = of(touched);
  return *std::ranges::max_element(contacts, {}, strength);
}

Mat3 SolidContact::free_of_pins(Index node) const {
  const auto found =
      std::ranges::lower_bound(partial_pins_, node, {}, &std::pair<Index, Mat3>::first);
  return found->second;
}

SolidContact::Normals SolidContact::normals_of(const TouchedNode& touched) const {
  Normals normals;
  for (const Contact& contact : of(touched)) {
    if (normals.count == most_normals) break;
    normals.n[normals.count++] = pin_ndof_[touched.node] == 3
                                     ? contact.normal
                                     : Vec3(free_of_pins(touched.node) * contact.normal);
  }
  return normals;
}

void SolidContact::renew_planes(std::span<const Vec3> x_end) {
  parallel_for(static_cast<Index>(touched_.size()), contact_grain, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) renew_planes(touched_[k], x_end[touched_[k].node]);
  });
}

void SolidContact::renew_planes(TouchedNode& touched, const Vec3& x_end) {
  const Contact* holding = touched.sticking ? &holder(touched) : nullptr;
  const Vec3& x0 = start_[touched.node];
  const Vec3& x1 = holding ? holding->target : x_end;
  touched.floats = false;
  for (Contact& contact : of(touched)) {
    const SolidStep& step = step_of(contact);
    if (&contact == holding) {
      contact.normal = step.end_normal(contact.anchor);
      contact.distance = contact.normal.dot(contact.target - x0);
      continue;
    }
    const LandingPlane plane = step.landing(x1, contact.anchor);
    contact.normal = plane.normal;
    contact.distance = plane.normal.dot(x1 - x0) - plane.gap;
    touched.floats |= std::abs(plane.gap) > depth_tolerance(step) && !contact.fresh;
  }
  if (!touched.friction.isZero(0.0))
    touched.friction = tangential_part(normals_of(touched).span(), touched.friction);
}

// ---- friction

Vec3 SolidContact::slip_of(const Contact& contact, const Normals& normals,
                           const Vec3& x_end) const {
  const Vec3 slip = x_end - contact.target;
  return tangential_part(normals.span(), pin_ndof_[contact.node] == 3
                                             ? slip
                                             : Vec3(free_of_pins(contact.node) * slip));
}

// Does the node move with its solids, but for a small share of its way?
bool SolidContact::rides(const TouchedNode& touched, const Normals& normals,
                         const Vec3& x_end) const {
  const double slack = std::max(still, riding_share * (x_end - start_[touched.node]).norm());
  return std::ranges::all_of(of(touched), [&](const Contact& contact) {
    return slip_of(contact, normals, x_end).norm() <= slack;
  });
}

double SolidContact::hold_of(const TouchedNode& touched) const {
  double hold = 0.0;
  for (const Contact& contact : of(touched))
    hold += step_of(contact).friction() * std::max(contact.lambda, 0.0);
  return hold;
}

// Sum over the contacts of mu lambda against the slip, to which what friction has taken from it (m)
// is added back.
Vec3 SolidContact::sliding_friction(const TouchedNode& touched, const Normals& normals,
                                    const Vec3& x_end, const Vec3& taken) const {
  Vec3 friction = Vec3::Zero();
  for (const Contact& contact : of(touched)) {
    const Vec3 slip = slip_of(contact, normals, x_end) - taken;
    const double length = slip.norm();
    if (length > still)
      friction -= step_of(contact).friction() * std::max(contact.lambda, 0.0) / length * slip;
  }
  return friction;
}

// Coulomb's friction against the slip that would be there without friction (`compliance` times
// friction is what it takes away), but no more than stops it. To go by the slip that is left would
// diverge for nodes close to rest.
Vec3 SolidContact::renewed_friction(const TouchedNode& touched, const Normals& normals,
                                    const Vec3& x_end) const {
  const Vec3 taken = touched.compliance * touched.friction;
  const Vec3 friction = sliding_friction(touched, normals, x_end, taken);
  if (touched.compliance == 0.0) return friction;
  const Vec3 stopping = (taken - slip_of(holder(touched), normals, x_end)) / touched.compliance;
  return stopping.squaredNorm() < friction.squaredNorm() ? stopping : friction;
}

// Nodes new to the set ride with the solid if they do not move on it, else slide; those of the step
// before go on.
void SolidContact::start_fresh(std::span<const Vec3> x_end) {
  for (TouchedNode& touched : touched_) {
    if (!std::exchange(touched.fresh, false) || touched.sticking || !has_friction(touched))
      continue;
    const double size = touched.friction.norm();
    // less than it can be: what stops the node
    if (size > 0.0 && size < (1.0 - friction_share) * hold_of(touched)) continue;
    const Vec3& x1 = x_end[touched.node];
    const Normals normals = normals_of(touched);
    touched.sticking = touched.wait == 0 && rides(touched, normals, x1);
    touched.friction = sliding_friction(touched, normals, x1, Vec3::Zero());
    if (touched.sticking) renew_planes(touched, x1);
  }
}

void SolidContact::judge(TouchedNode& touched, const Vec3& x_end, const Vec3& impulse,
                         double negligible) {
  touched.turned = false;
  touched.change = 0.0;
  const Normals normals = normals_of(touched);
  std::array<double, most_normals> lambda{};
  const Vec3 free_impulse =
      pin_ndof_[touched.node] == 3 ? impulse : Vec3(free_of_pins(touched.node) * impulse);
  const Vec3 tangential =
      split_impulse(normals.span(), free_impulse, {lambda.data(), normals.count});
  Contact* pulling = nullptr;
  const std::span<Contact> contacts = of(touched);
  for (std::size_t k = 0; k < normals.count; ++k) {
    contacts[k].lambda = lambda[k];
    if (lambda[k] < -negligible && !contacts[k].stays && (!pulling || lambda[k] < pulling->lambda))
      pulling = &contacts[k];
  }
  touched.hold = hold_of(touched);
  if (pulling) pulling->released = true;
  if (pulling || counts_.passes > friction_passes || touched.updates == friction_updates ||
      !has_friction(touched))
    return;
  ++touched.updates;
  if (touched.sticking)
    judge_stick(touched, tangential, negligible);
  else
    judge_slide(touched, normals, x_end);
}

void SolidContact::judge_stick(TouchedNode& touched, const Vec3& tangential, double negligible) {
  const double needed = tangential.norm();
  if (needed <= touched.hold + negligible) return;
  touched.sticking = false;
  touched.turned = touched.turned_loose = true;
  touched.change = needed - touched.hold;
  touched.friction = touched.hold / needed * tangential;
  touched.last_friction = tangential;
  touched.last_slip = Vec3::Zero();
}

void SolidContact::judge_slide(TouchedNode& touched, const Normals& normals, const Vec3& x_end) {
  const Vec3 slip = slip_of(holder(touched), normals, x_end);
  learn_compliance(touched, slip);
  const bool reversed = slip.dot(touched.friction) > 0.0;
  touched.last_friction = touched.friction;
  touched.last_slip = slip;
  // Friction that drives the node instead of slowing it is too much; how much is not known before a
  // second pass.
  const bool unknown = touched.compliance == 0.0 && reversed;
  const Vec3 renewed =
      unknown ? Vec3(0.5 * touched.friction) : renewed_friction(touched, normals, x_end);
  touched.holds = reversed || renewed.norm() < (1.0 - friction_share) * touched.hold;
  touched.change = (renewed - touched.friction).norm();
  touched.friction = renewed;
}

void SolidContact::learn_compliance(TouchedNode& touched, const Vec3& slip) {
  if (!touched.last_slip) return;
  const Vec3 impulse = touched.friction - touched.last_friction;
  const double size = impulse.squaredNorm();
  if (size <= friction_share * friction_share * touched.hold * touched.hold) return;
  const double compliance = impulse.dot(slip - *touched.last_slip) / size;
  if (compliance > 0.0) touched.compliance = compliance;
}

void SolidContact::fill_impulses() {
  impulses_.clear();
  const auto slides = [](const TouchedNode& touched) { return !touched.friction.isZero(0.0); };
  if (std::ranges::none_of(touched_, slides)) return;
  impulses_.assign(static_cast<std::size_t>(nodes_), Vec3::Zero());
  for (const TouchedNode& touched : touched_) impulses_[touched.node] = touched.friction;
}

// ---- from step to step

int SolidContact::sticking() const {
  return static_cast<int>(std::ranges::count_if(touched_, &TouchedNode::sticking));
}

void SolidContact::remember() {
  kept_ = {};
  for (const TouchedNode& touched : touched_) {
    const Vec3 friction = touched.friction / h_;
    const ContactStick stick{touched.sticking, static_cast<std::uint8_t>(touched.wait),
                             static_cast<std::uint8_t>(touched.longest)};
    for (const Contact& contact : of(touched)) {
      kept_.node.push_back(contact.node);
      kept_.solid.push_back(contact.solid);
      kept_.sticking.push_back(stick);
      kept_.normal_force.push_back({std::max(contact.lambda, 0.0) / h_,
                                    {friction.x(), friction.y(), friction.z()},
                                    touched.compliance / h_});
    }
  }
}

void SolidContact::restore(ContactState state) {
  const std::size_t n = state.node.size();
  if (state.solid.size() != n || state.sticking.size() != n || state.normal_force.size() != n)
    throw InputError(
        "contact state: the lists have different lengths; the checkpoint is damaged, start from an "
        "earlier one");
  for (std::size_t k = 0; k < n; ++k) {
    const bool inside = state.node[k] >= 0 && state.node[k] < nodes_ && state.solid[k] >= 0 &&
                        state.solid[k] < std::ssize(solids_);
    const bool ordered = k == 0 || std::tie(state.node[k - 1], state.solid[k - 1]) <
                                       std::tie(state.node[k], state.solid[k]);
    if (!inside || !ordered)
      throw InputError("contact state: entry " + std::to_string(k) + " (node " +
                       std::to_string(state.node[k]) + ", solid " + std::to_string(state.solid[k]) +
                       ") is out of range or out of order; expected nodes below " +
                       std::to_string(nodes_) + " and solids below " +
                       std::to_string(solids_.size()) +
                       ": the checkpoint belongs to another scene");
  }
  kept_ = std::move(state);
}

}  // namespace taut
