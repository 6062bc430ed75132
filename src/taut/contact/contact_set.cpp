#include "taut/contact/contact_set.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <tuple>

#include "taut/base/parallel.h"
#include "taut/contact/impulse_split.h"

namespace taut {
namespace {

constexpr double pull_share = 1e-2;  // of all pushes: pulls that may wait until the next step
// passes asked for because a node floats over a curved surface or an edge, in one step
constexpr int most_renewals = 2;
constexpr int most_releases = 2;          // of one contact in one step
constexpr std::size_t most_normals = 16;  // of one node; any further ones depend on them
constexpr Index node_grain = 4096, contact_grain = 256;

bool in_order(const Contact& a, const Contact& b) {
  return std::tie(a.node, a.solid) < std::tie(b.node, b.solid);
}

}  // namespace

struct ContactSet::Normals {
  std::array<Vec3, most_normals> n;
  std::size_t count = 0;
  std::span<const Vec3> span() const { return {n.data(), count}; }
};

ContactSet::ContactSet(SolidObstacles obstacles)
    : obstacles_(std::move(obstacles)), met_(static_cast<std::size_t>(obstacles_.nodes())) {}

// ---- which contacts there are

int ContactSet::begin_step(double t, double h, std::span<const Vec3> x,
                           std::span<const Vec3> x_predicted, const ConstraintSet& pins,
                           const ContactState& before) {
  assert(std::ssize(x_predicted) == obstacles_.nodes() && pins.nodes() == obstacles_.nodes());
  obstacles_.begin_step(t, h, x);
  read_pins(pins);
  releases_.clear();
  touched_.clear();
  keep_contacts(h, x_predicted, before);
  const int added = add_predicted(x_predicted);
  group();
  recall_friction(h, before);
  return added;
}

void ContactSet::read_pins(const ConstraintSet& pins) {
  pin_ndof_.assign(pins.ndofs().begin(), pins.ndofs().end());
  partial_pins_.clear();
  for (Index i = 0; i < pins.nodes(); ++i)
    if (pins.ndof(i) == 1 || pins.ndof(i) == 2) partial_pins_.emplace_back(i, pins.projection(i));
}

Contact ContactSet::contact_at(Index node, Index solid, const Vec3& x_end,
                               double touch_tolerance) const {
  const SolidStep& step = obstacles_.step(solid);
  Contact contact;
  contact.node = node;
  contact.solid = solid;
  contact.anchor = step.anchor(obstacles_.start(node), x_end, touch_tolerance);
  contact.target = step.carried(contact.anchor);
  return contact;
}

void ContactSet::keep_contacts(double h, std::span<const Vec3> x_predicted,
                               const ContactState& before) {
  contacts_.clear();
  for (std::size_t k = 0; k < before.node.size(); ++k) {
    const Index node = before.node[k], solid = before.solid[k];
    const SolidStep& step = obstacles_.step(solid);
    // A node left floating over a curved surface is still in contact; one that something else has
    // moved away is not.
    const double tolerance =
        std::max(obstacles_.touch_tolerance(), 2.0 * step.floating_tolerance());
    if (pin_ndof_[node] == 0 || step.start_gap(obstacles_.start(node)) > tolerance) continue;
    Contact& contact =
        contacts_.emplace_back(contact_at(node, solid, x_predicted[node], tolerance));
    contact.kept = static_cast<Index>(k);
    contact.lambda = h * before.normal_force[k].normal;
  }
}

// Contacts of the nodes for which meets(solid, node) holds and that are not there yet.
template <class Meets>
int ContactSet::add_met(std::span<const Vec3> x_end, const Meets& meets) {
  const Index nodes = obstacles_.nodes();
  const auto before = std::ssize(contacts_);
  for (Index s = 0; s < std::ssize(obstacles_.solids()); ++s) {
    parallel_for(nodes, node_grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        met_[i] = pin_ndof_[i] != 0 && obstacles_.may_meet(s, i) && meets(s, i);
    });
    Contact wanted;
    wanted.solid = s;
    for (Index i = 0; i < nodes; ++i) {
      if (!met_[i]) continue;
      wanted.node = i;
      if (std::binary_search(contacts_.begin(), contacts_.begin() + before, wanted, in_order))
        continue;
      contacts_.push_back(contact_at(i, s, x_end[i], obstacles_.touch_tolerance()));
      const auto released = releases_.find({i, s});
      contacts_.back().stays = released != releases_.end() && released->second >= most_releases;
    }
  }
  std::sort(contacts_.begin() + before, contacts_.end(), in_order);
  std::inplace_merge(contacts_.begin(), contacts_.begin() + before, contacts_.end(), in_order);
  return static_cast<int>(std::ssize(contacts_) - before);
}

int ContactSet::add_predicted(std::span<const Vec3> x_predicted) {
  const double touch = obstacles_.touch_tolerance();
  return add_met(x_predicted, [&](Index solid, Index node) {
    const SolidStep& step = obstacles_.step(solid);
    const Vec3 &x0 = obstacles_.start(node), &x1 = x_predicted[node];
    // The second line: a node that lies on a curved surface and moves along it, straight on as far
    // as is known yet.
    return step.meets(x0, x1, touch) ||
           (step.meets(x0, x1, obstacles_.depth_tolerance(solid)) && step.start_gap(x0) <= touch);
  });
}

ContactSet::Change ContactSet::add_inside(std::span<const Vec3> x_end) {
  for (Contact& contact : contacts_) contact.fresh = false;
  const auto deeper = [&](Index solid, Index node, double depth) {
    return obstacles_.step(solid).meets(obstacles_.start(node), x_end[node], -depth);
  };
  Change change;
  change.contacts = add_met(x_end, [&](Index solid, Index node) {
    return deeper(solid, node, obstacles_.touch_tolerance());
  });
  if (change.contacts > 0) group();
  // What is barely inside can wait: it is in the set from the next step on.
  change.matters = std::ranges::any_of(contacts_, [&](const Contact& contact) {
    return contact.fresh &&
           deeper(contact.solid, contact.node, obstacles_.depth_tolerance(contact.solid));
  });
  return change;
}

ContactSet::Change ContactSet::drop_released() {
  Change change;
  double pull = 0.0, push = 0.0;
  for (const Contact& contact : contacts_) {
    push += std::max(contact.lambda, 0.0);
    if (!contact.released) continue;
    pull -= contact.lambda;
    ++change.contacts;
    ++releases_[{contact.node, contact.solid}];
  }
  if (change.contacts > 0) {
    std::erase_if(contacts_, [](const Contact& contact) { return contact.released; });
    group();
  }
  change.matters = pull > pull_share * push;
  return change;
}

// Makes the list of nodes from that of contacts; nodes that were there go on.
void ContactSet::group() {
  std::vector<TouchedNode> grouped;
  auto old = touched_.begin();
  for (Index first = 0; first < std::ssize(contacts_);) {
    const Index node = contacts_[first].node;
    while (old != touched_.end() && old->node < node) ++old;
    const bool known = old != touched_.end() && old->node == node;
    TouchedNode& touched = grouped.emplace_back(known ? *old : TouchedNode{});
    touched.node = node;
    touched.first = first;
    while (first < std::ssize(contacts_) && contacts_[first].node == node) ++first;
    touched.count = first - touched.first;
    touched.fresh = !known;
    if (!has_friction(touched)) touched.friction.lose_hold();
  }
  touched_ = std::move(grouped);
  slips_.resize(contacts_.size());
}

void ContactSet::recall_friction(double h, const ContactState& before) {
  for (TouchedNode& touched : touched_) {
    Index kept = -1;
    for (const Contact& contact : of(touched)) kept = std::max(kept, contact.kept);
    if (kept < 0) continue;
    const auto k = static_cast<std::size_t>(kept);
    touched.friction = StickSlip(before.sticking[k], before.normal_force[k], h);
    if (!has_friction(touched)) touched.friction.lose_hold();
  }
}

// ---- planes

Vec3 ContactSet::free_part(Index node, const Vec3& a) const {
  if (pin_ndof_[node] == 3) return a;
  const auto found =
      std::ranges::lower_bound(partial_pins_, node, {}, &std::pair<Index, Mat3>::first);
  return found->second * a;
}

ContactSet::Normals ContactSet::normals_of(const TouchedNode& touched) const {
  Normals normals;
  for (const Contact& contact : of(touched)) {
    if (normals.count == most_normals) break;
    normals.n[normals.count++] = free_part(touched.node, contact.normal);
  }
  return normals;
}

void ContactSet::renew_planes(std::span<const Vec3> x_end) {
  parallel_for(static_cast<Index>(touched_.size()), contact_grain, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) renew_planes(touched_[k], x_end[touched_[k].node]);
  });
}

void ContactSet::renew_planes(TouchedNode& touched, const Vec3& x_end) {
  const std::span<Contact> contacts = writable(touched);
  const Contact* holding = touched.friction.sticks() ? &contacts[holder(touched)] : nullptr;
  const Vec3& x0 = obstacles_.start(touched.node);
  const Vec3& x1 = holding ? holding->target : x_end;
  touched.floats = false;
  for (Contact& contact : contacts) {
    const SolidStep& step = step_of(contact);
    if (&contact == holding) {
      contact.normal = step.end_normal(contact.anchor);
      contact.distance = contact.normal.dot(contact.target - x0);
      continue;
    }
    const LandingPlane plane = step.landing(x1, contact.anchor);
    contact.normal = plane.normal;
    contact.distance = plane.normal.dot(x1 - x0) - plane.gap;
    touched.floats |=
        std::abs(plane.gap) > obstacles_.depth_tolerance(contact.solid) && !contact.fresh;
  }
  if (!touched.friction.impulse().isZero(0.0)) touched.friction.turn_to(normals_of(touched).span());
}

bool ContactSet::ask_for_floating() {
  bool floats = false;
  for (TouchedNode& touched : touched_)
    floats |= touched.floats && ++touched.renewals <= most_renewals;
  return floats;
}

void ContactSet::constrain(ConstraintSet& constraints) const {
  for (const TouchedNode& touched : touched_) {
    const Index i = touched.node;
    for (const Contact& contact : of(touched))
      constraints.constrain(i, contact.normal, contact.distance);
    if (!touched.friction.sticks()) continue;
    const Vec3 ride = of(touched)[holder(touched)].target - obstacles_.start(i);
    constraints.fix(i, constraints.displacement(i) + constraints.free_part(i, ride));
  }
}

// ---- impulses and slips

ContactSet::Share ContactSet::split(const TouchedNode& touched, const Vec3& impulse,
                                    double negligible) {
  const Normals normals = normals_of(touched);
  std::array<double, most_normals> lambda{};
  Share share;
  share.tangential = split_impulse(normals.span(), free_part(touched.node, impulse),
                                   {lambda.data(), normals.count});
  Contact* pulling = nullptr;
  const std::span<Contact> contacts = writable(touched);
  for (std::size_t k = 0; k < normals.count; ++k) {
    contacts[k].lambda = lambda[k];
    if (lambda[k] < -negligible && !contacts[k].stays && (!pulling || lambda[k] < pulling->lambda))
      pulling = &contacts[k];
  }
  share.pulls = pulling != nullptr;
  if (pulling) pulling->released = true;
  return share;
}

bool ContactSet::has_friction(const TouchedNode& touched) const {
  return std::ranges::any_of(
      of(touched), [&](const Contact& contact) { return step_of(contact).friction() > 0.0; });
}

double ContactSet::hold(const Contact& contact) const {
  return step_of(contact).friction() * std::max(contact.lambda, 0.0);
}

double ContactSet::hold(const TouchedNode& touched) const {
  double hold_of_all = 0.0;
  for (const Contact& contact : of(touched)) hold_of_all += hold(contact);
  return hold_of_all;
}

std::size_t ContactSet::holder(const TouchedNode& touched) const {
  const auto strength = [&](const Contact& contact) {
    return std::pair(hold(contact), step_of(contact).friction());
  };
  const auto contacts = of(touched);
  return static_cast<std::size_t>(std::ranges::max_element(contacts, {}, strength) -
                                  contacts.begin());
}

std::span<const ContactSlip> ContactSet::slips(const TouchedNode& touched, const Vec3& x_end) {
  const Normals normals = normals_of(touched);
  const std::span<ContactSlip> slips = std::span(slips_).subspan(
      static_cast<std::size_t>(touched.first), static_cast<std::size_t>(touched.count));
  const auto contacts = of(touched);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Vec3 moved = x_end - contacts[k].target;
    slips[k] = {hold(contacts[k]), tangential_part(normals.span(), free_part(touched.node, moved))};
  }
  return slips;
}

}  // namespace taut
