#include "taut/contact/solid_contact.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <tuple>

#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/contact/impulse_split.h"

namespace taut {
namespace {

constexpr double pull_share = 1e-9;       // of the largest impulse: a pull below it is rounding
constexpr double friction_share = 1e-2;   // friction of all nodes together that may be out of date at the fixed point
constexpr double still = 1e-12;           // m: relative motion in one step below which a node does not slide
constexpr int most_slides = 3;            // turns from stick to slide in one step
constexpr int most_renewals = 2;          // passes asked for because a node floats over a curved surface or an edge, in one step
constexpr int most_releases = 2;          // of one contact in one step
constexpr std::size_t most_normals = 16;  // of one node; any further ones depend on them
constexpr Index node_grain = 4096, contact_grain = 256;

}  // namespace

struct SolidContact::Normals {
  std::array<Vec3, most_normals> n;
  std::size_t count = 0;
  std::span<const Vec3> span() const { return {n.data(), count}; }
};

SolidContact::SolidContact(std::vector<Solid> solids, Index nodes, ContactOptions options)
    : solids_(std::move(solids)), options_(options), nodes_(nodes), met_(static_cast<std::size_t>(nodes)) {}

// ---- one step --------------------------------------------------------------------------------------------------------------------

void SolidContact::begin_step(double t, double h, std::span<const Vec3> x, std::span<const Vec3> x_predicted, const ConstraintSet& pins) {
  assert(std::ssize(x) == nodes_ && std::ssize(x_predicted) == nodes_ && pins.nodes() == nodes_ && h > 0.0);
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
  counts_.added = add_met(x_predicted, options_.touch_tolerance);
  group();
  renew_planes(x_predicted);
  start_friction(x_predicted);
  renew_planes(x_predicted);
  fill_impulses();
}

void SolidContact::constrain(ConstraintSet& constraints) const {
  for (const TouchedNode& touched : touched_) {
    const Index i = touched.node;
    for (const Contact& contact : of(touched)) constraints.constrain(i, contact.normal, contact.distance);
    if (!touched.sticking) continue;
    const Vec3 ride = holder(touched).target - start_[i];
    constraints.fix(i, constraints.displacement(i) + constraints.free_part(i, ride));
  }
}

std::span<const Vec3> SolidContact::impulses() const { return impulses_; }

bool SolidContact::update(std::span<const Vec3> x_end, std::span<const Vec3> constraint_impulse) {
  ++counts_.passes;
  double largest = 0.0;
  for (const TouchedNode& touched : touched_) largest = std::max(largest, constraint_impulse[touched.node].squaredNorm());
  const double negligible = pull_share * std::sqrt(largest);
  parallel_for(static_cast<Index>(touched_.size()), contact_grain, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) judge(touched_[k], x_end[touched_[k].node], constraint_impulse[touched_[k].node], negligible);
  });

  double friction = 0.0, change = 0.0;
  bool turned = false, floats = false;
  for (const TouchedNode& touched : touched_) {
    friction += touched.friction.norm();
    change += touched.change;
    turned |= touched.turned;
    if (touched.turned) ++(touched.sticking ? counts_.slide_to_stick : counts_.stick_to_slide);
  }
  const int released = drop_released();
  const int added = add_met(x_end, -options_.touch_tolerance);
  counts_.released += released;
  counts_.added += added;
  if (released + added > 0) group();
  renew_planes(x_end);
  for (TouchedNode& touched : touched_) floats |= touched.floats && ++touched.renewals <= most_renewals;
  fill_impulses();
  const bool changed = turned || floats || released + added > 0 || change > friction_share * friction;
  if (getenv("DBG") && counts_.passes >= options_.max_passes - 2)
    std::printf("   pass %d turned %d floats %d rel %d add %d change %g of %g\n", counts_.passes, turned, floats, released, added, change,
                friction);
  return changed && counts_.passes < options_.max_passes;
}

Index SolidContact::finish(std::span<Vec3> x_end) {
  std::vector<double> depth(static_cast<std::size_t>(nodes_), 0.0);
  parallel_for(nodes_, node_grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) met_[i] = move_out(i, x_end[i], depth[i]);
  });
  for (Index i = 0; i < nodes_; ++i) {
    counts_.moved += met_[i];
    counts_.deepest = std::max(counts_.deepest, depth[i]);
  }
  remember();
  return counts_.moved;
}

bool SolidContact::move_out(Index node, Vec3& x_end, double& depth) const {
  if (pin_ndof_[node] != 3) return false;
  bool moved = false;
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    if (!steps_[s].meets(start_[node], x_end, -options_.touch_tolerance)) continue;
    const Vec3 anchor = steps_[s].anchor(start_[node], x_end, options_.touch_tolerance);
    const LandingPlane plane = steps_[s].landing(x_end, anchor);
    depth = std::max(depth, -plane.gap);
    x_end -= plane.gap * plane.normal;
    moved = true;
  }
  return moved;
}

// ---- which contacts there are ----------------------------------------------------------------------------------------------------

SolidContact::Contact SolidContact::contact_at(Index node, Index solid, const Vec3& x_end, double touch_tolerance) const {
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
    // A node left floating over a curved surface is still in contact; one that something else has moved away is not.
    const double tolerance = std::max(options_.touch_tolerance, 2.0 * step.floating_tolerance());
    if (pin_ndof_[node] == 0 || step.start_gap(start_[node]) > tolerance) continue;
    Contact& contact = contacts_.emplace_back(contact_at(node, solid, x_predicted[node], tolerance));
    contact.slid_before = !kept_.sticking[k];
    contact.lambda = h * kept_.normal_force[k];
  }
}

void SolidContact::find_met(const SolidStep& step, std::span<const Vec3> x_end, double largest_gap) {
  parallel_for(nodes_, node_grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) met_[i] = pin_ndof_[i] != 0 && step.meets(start_[i], x_end[i], largest_gap);
  });
}

int SolidContact::add_met(std::span<const Vec3> x_end, double largest_gap) {
  constexpr auto order = [](const Contact& a, const Contact& b) { return std::tie(a.node, a.solid) < std::tie(b.node, b.solid); };
  const std::size_t before = contacts_.size();
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    find_met(steps_[s], x_end, largest_gap);
    Contact wanted;
    wanted.solid = static_cast<Index>(s);
    for (Index i = 0; i < nodes_; ++i) {
      if (!met_[i]) continue;
      wanted.node = i;
      if (std::binary_search(contacts_.begin(), contacts_.begin() + static_cast<std::ptrdiff_t>(before), wanted, order)) continue;
      contacts_.push_back(contact_at(i, wanted.solid, x_end[i], options_.touch_tolerance));
      const auto released = releases_.find({i, wanted.solid});
      contacts_.back().stays = released != releases_.end() && released->second >= most_releases;
    }
  }
  std::sort(contacts_.begin() + static_cast<std::ptrdiff_t>(before), contacts_.end(), order);
  std::inplace_merge(contacts_.begin(), contacts_.begin() + static_cast<std::ptrdiff_t>(before), contacts_.end(), order);
  return static_cast<int>(contacts_.size() - before);
}

int SolidContact::drop_released() {
  int count = 0;
  for (const Contact& contact : contacts_) {
    if (!contact.released) continue;
    ++count;
    ++releases_[{contact.node, contact.solid}];
  }
  if (count > 0) std::erase_if(contacts_, [](const Contact& contact) { return contact.released; });
  return count;
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
    bool slid_before = false;
    for (; first < std::ssize(contacts_) && contacts_[first].node == node; ++first, ++touched.count)
      slid_before |= contacts_[first].slid_before;
    if (!known) touched.sticking = has_friction(touched) && !slid_before;
    if (!has_friction(touched)) touched.sticking = false;
    grouped.push_back(touched);
  }
  touched_ = std::move(grouped);
}

// ---- normals and planes ----------------------------------------------------------------------------------------------------------

bool SolidContact::has_friction(const TouchedNode& touched) const {
  return std::ranges::any_of(of(touched), [&](const Contact& contact) { return step_of(contact).friction() > 0.0; });
}

// The contact whose solid a sticking node rides with: the one that can hold most.
const SolidContact::Contact& SolidContact::holder(const TouchedNode& touched) const {
  const auto strength = [&](const Contact& c) { return std::pair(step_of(c).friction() * std::max(c.lambda, 0.0), step_of(c).friction()); };
  const auto contacts = of(touched);
  return *std::ranges::max_element(contacts, {}, strength);
}

Mat3 SolidContact::free_of_pins(Index node) const {
  const auto found = std::ranges::lower_bound(partial_pins_, node, {}, &std::pair<Index, Mat3>::first);
  return found->second;
}

SolidContact::Normals SolidContact::normals_of(const TouchedNode& touched) const {
  Normals normals;
  for (const Contact& contact : of(touched)) {
    if (normals.count == most_normals) break;
    normals.n[normals.count++] = pin_ndof_[touched.node] == 3 ? contact.normal : Vec3(free_of_pins(touched.node) * contact.normal);
  }
  return normals;
}

void SolidContact::renew_planes(std::span<const Vec3> x_end) {
  parallel_for(static_cast<Index>(touched_.size()), contact_grain, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) {
      TouchedNode& touched = touched_[k];
      const Contact* holding = touched.sticking ? &holder(touched) : nullptr;
      touched.floats = false;
      for (Contact& contact : of(touched)) {
        const SolidStep& step = step_of(contact);
        const Vec3& x0 = start_[contact.node];
        if (&contact == holding) {
          contact.normal = step.end_normal(contact.anchor);
          contact.distance = contact.normal.dot(contact.target - x0);
          continue;
        }
        const Vec3& x1 = touched.sticking ? holding->target : x_end[contact.node];
        const LandingPlane plane = step.landing(x1, contact.anchor);
        contact.normal = plane.normal;
        contact.distance = plane.normal.dot(x1 - x0) - plane.gap;
        touched.floats |= std::abs(plane.gap) > std::max(options_.touch_tolerance, step.floating_tolerance());
      }
      if (!touched.friction.isZero(0.0)) touched.friction = tangential_part(normals_of(touched).span(), touched.friction);
    }
  });
}

// ---- friction --------------------------------------------------------------------------------------------------------------------

Vec3 SolidContact::slip_of(const Contact& contact, const Normals& normals, const Vec3& x_end) const {
  const Vec3 slip = x_end - contact.target;
  return tangential_part(normals.span(), pin_ndof_[contact.node] == 3 ? slip : Vec3(free_of_pins(contact.node) * slip));
}

bool SolidContact::slips(const TouchedNode& touched, const Normals& normals, const Vec3& x_end) const {
  return std::ranges::any_of(of(touched), [&](const Contact& contact) { return slip_of(contact, normals, x_end).norm() > still; });
}

// Sum over the node's contacts of mu lambda against its motion relative to that solid. `without` (m) is what friction took from that
// motion.
Vec3 SolidContact::friction_of(const TouchedNode& touched, const Normals& normals, const Vec3& x_end, const Vec3& without) const {
  Vec3 friction = Vec3::Zero();
  for (const Contact& contact : of(touched)) {
    const Vec3 slip = slip_of(contact, normals, x_end) + without;
    const double length = slip.norm();
    if (length > still) friction -= step_of(contact).friction() * std::max(contact.lambda, 0.0) / length * slip;
  }
  return friction;
}

void SolidContact::start_friction(std::span<const Vec3> x_predicted) {
  for (TouchedNode& touched : touched_) {
    if (touched.sticking || !has_friction(touched)) continue;
    const Normals normals = normals_of(touched);
    touched.friction = friction_of(touched, normals, x_predicted[touched.node], Vec3::Zero());
    touched.sticking = !slips(touched, normals, x_predicted[touched.node]);
  }
}

void SolidContact::judge(TouchedNode& touched, const Vec3& x_end, const Vec3& impulse, double negligible) {
  touched.turned = false;
  touched.change = 0.0;
  const Normals normals = normals_of(touched);
  std::array<double, most_normals> lambda{};
  const Vec3 free_impulse = pin_ndof_[touched.node] == 3 ? impulse : Vec3(free_of_pins(touched.node) * impulse);
  const Vec3 tangential = split_impulse(normals.span(), free_impulse, {lambda.data(), normals.count});
  Contact* pulling = nullptr;
  const std::span<Contact> contacts = of(touched);
  for (std::size_t k = 0; k < normals.count; ++k) {
    contacts[k].lambda = lambda[k];
    if (lambda[k] < -negligible && !contacts[k].stays && (!pulling || lambda[k] < pulling->lambda)) pulling = &contacts[k];
  }
  if (pulling)
    pulling->released = true;
  else if (touched.sticking)
    judge_stick(touched, tangential, negligible);
  else if (has_friction(touched))
    judge_slide(touched, normals, x_end);
}

void SolidContact::judge_stick(TouchedNode& touched, const Vec3& tangential, double negligible) {
  double hold = 0.0;
  for (const Contact& contact : of(touched)) hold += step_of(contact).friction() * std::max(contact.lambda, 0.0);
  const double pull = tangential.norm();
  if (pull <= hold + negligible || touched.slides == most_slides) return;
  touched.sticking = false;
  touched.turned = true;
  ++touched.slides;
  touched.friction = hold / pull * tangential;
  touched.last_friction = tangential;
  touched.last_slip = Vec3::Zero();
}

void SolidContact::judge_slide(TouchedNode& touched, const Normals& normals, const Vec3& x_end) {
  const Vec3 slip = slip_of(holder(touched), normals, x_end);
  // Friction that would drive the node instead of slowing it: the node has come to rest within the step.
  if (slip.dot(touched.friction) > 0.0 || !slips(touched, normals, x_end)) {
    touched.sticking = true;
    touched.turned = true;
    touched.friction.setZero();
    return;
  }
  // Friction opposes the slip that would be there without it. Two passes tell how much slip an impulse takes away; to go by the slip that
  // is left would diverge for nodes close to rest.
  if (touched.last_slip) {
    const double impulse = (touched.friction - touched.last_friction).norm(), answer = (slip - *touched.last_slip).norm();
    if (impulse > friction_share * touched.friction.norm()) touched.compliance = answer / impulse;
  }
  const Vec3 without = -touched.compliance * touched.friction;
  touched.last_friction = touched.friction;
  touched.last_slip = slip;
  const Vec3 renewed = friction_of(touched, normals, x_end, without);
  touched.change = (renewed - touched.friction).norm();
  touched.friction = renewed;
}

void SolidContact::fill_impulses() {
  impulses_.clear();
  const auto slides = [](const TouchedNode& touched) { return !touched.friction.isZero(0.0); };
  if (std::ranges::none_of(touched_, slides)) return;
  impulses_.assign(static_cast<std::size_t>(nodes_), Vec3::Zero());
  for (const TouchedNode& touched : touched_) impulses_[touched.node] = touched.friction;
}

// ---- from step to step -----------------------------------------------------------------------------------------------------------

int SolidContact::sticking() const { return static_cast<int>(std::ranges::count_if(touched_, &TouchedNode::sticking)); }

void SolidContact::remember() {
  kept_ = {};
  for (const TouchedNode& touched : touched_)
    for (const Contact& contact : of(touched)) {
      kept_.node.push_back(contact.node);
      kept_.solid.push_back(contact.solid);
      kept_.sticking.push_back(touched.sticking);
      kept_.normal_force.push_back(std::max(contact.lambda, 0.0) / h_);
    }
}

void SolidContact::restore(ContactState state) {
  const std::size_t n = state.node.size();
  if (state.solid.size() != n || state.sticking.size() != n || state.normal_force.size() != n)
    throw InputError("contact state: the lists have different lengths; the checkpoint is damaged, start from an earlier one");
  for (std::size_t k = 0; k < n; ++k) {
    const bool inside = state.node[k] >= 0 && state.node[k] < nodes_ && state.solid[k] >= 0 && state.solid[k] < std::ssize(solids_);
    const bool ordered = k == 0 || std::tie(state.node[k - 1], state.solid[k - 1]) < std::tie(state.node[k], state.solid[k]);
    if (!inside || !ordered)
      throw InputError("contact state: entry " + std::to_string(k) + " (node " + std::to_string(state.node[k]) + ", solid " +
                       std::to_string(state.solid[k]) + ") is out of range or out of order; expected nodes below " +
                       std::to_string(nodes_) + " and solids below " + std::to_string(solids_.size()) +
                       ": the checkpoint belongs to another scene");
  }
  kept_ = std::move(state);
}

}  // namespace taut
