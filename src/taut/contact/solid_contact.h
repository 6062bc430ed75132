#pragma once
// Contact of cloth nodes with solids as an active set of constraints (docs/mathematics.md, 3.5 and
// 3.6; paper Eq. 3-6). Knows nothing of integrators: it hands over constraints and friction
// impulses, and judges the constraint impulses that come back.
//
//   contact          a pair (node, solid). Its normal n and distance say n·(x_end - x_start) =
//                    distance: the node ends on the plane that touches the solid's surface (outside
//                    its thickness) at the end of the step. Two contacts that are not parallel
//                    leave ndof 1, three leave 0; parallel ones merge (constraint_set.h)
//   j                constraint impulse on a node, N s, pointing as the solid pushes:  (I - S)(A dv
//   - b)
//   lambda_k         j split along the node's contact normals (impulse_split.h), N s; j_t what is
//                    left. A contact is let go when lambda < 0
//   sticking         ndof 0: the node ends where the solid's material point carries it. Holds while
//                    |j_t| <= sum mu_k lambda_k
//   sliding          ndof 2 (or 1): friction impulse of at most sum mu_k lambda_k against the slip
//                    (motion relative to the solid, in the directions that the normals leave free),
//                    and never more than stops it
//
// One step is   begin_step; do { constrain; solve with impulses } while (update); finish.
// The set begins with the contacts of the step before and nodes that are predicted to touch. A node
// that hardly slips (1 % of its way) sticks, others slide. A pass changes the set where it is
// wrong: it releases what pulls (of one node's contacts the one that pulls most), adds nodes that
// ended inside, turns stick into slide, renews friction, and renews the planes of nodes that float
// over a curved surface. Sliding becomes sticking at the end of a step, where friction was more
// than enough to stop the node; a node that broke loose waits 1, 3, 7, 15 steps.
//
// Each pass costs a linear solve, so small faults wait for the next step, which begins with them
// mended: a node inside by less than 2e-4 of the solid's size (touch_tolerance on planes), pulls of
// together less than 1 % of all pushes, friction that is off by together less than 5 % of what all
// nodes can hold. Friction is renewed at most 3 times a node and not after pass 4: then only
// normals change, which ends. Against cycling: a contact that was let go twice in a step and hit
// again stays until the next step. What still ends inside at the pass limit, `finish` moves to the
// surface.
//
// Deterministic (order: node, then solid; the same bits for any thread count). One step at a time,
// one thread calls; loops run in parallel.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "taut/constraint/constraint_set.h"
#include "taut/contact/contact_options.h"
#include "taut/contact/solid_step.h"

namespace taut {

// What is remembered of a contact from one step to the next. Friction, inverse mass and the waits
// are the node's, the same for all its contacts.
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

// One entry a contact, ordered by node, then solid. Elements without padding, so that a checkpoint
// may store them as bytes.
struct ContactState {
  std::vector<Index> node;
  std::vector<Index> solid;
  std::vector<ContactStick> sticking;
  std::vector<ContactForce> normal_force;
  bool operator==(const ContactState&) const = default;
};

// Of the current (or last) step.
struct ContactCounts {
  int passes = 0;  // calls of update
  int added = 0;   // contacts that were not there when the step began to be solved
  int released = 0;
  int stick_to_slide = 0;
  int slide_to_stick = 0;
  int moved = 0;  // nodes that finish moved out
  // m: the greatest depth of a node inside a solid before finish moved it; 0 if none
  double deepest = 0.0;
};

// A solid in a node's way: the plane n·x = offset on which the node may end.
struct Obstacle {
  Index solid = 0;
  Vec3 normal = Vec3::UnitZ();
  double offset = 0.0;          // m
  Vec3 carried = Vec3::Zero();  // m: where the solid's motion takes the node's place at the start
  double friction = 0.0;
};

class SolidContact {
 public:
  // meets: one list a solid, of one byte a node: 1 where the node may touch it; an empty list, or
  // none at all: all nodes.
  SolidContact(std::vector<Solid> solids, Index nodes, ContactOptions options,
               std::vector<std::vector<std::uint8_t>> meets = {});

  // Start of a step [t, t + h] (s). x: node positions at t, m; x_predicted: where they would be at
  // t + h without contact (x + h v). pins: the constraints so far; a node with ndof 0 there is
  // never a contact. All three are copied as far as they are needed. May be called again for the
  // same step (with another h) as long as finish was not.
  void begin_step(double t, double h, std::span<const Vec3> x, std::span<const Vec3> x_predicted,
                  const ConstraintSet& pins);
  // Adds this pass's contacts to `constraints`, which starts as the pins'.
  void constrain(ConstraintSet& constraints) const;
  // Friction of sliding nodes, one impulse a node, N s, to be added to this pass's momentum
  // equation. Empty if there is none.
  std::span<const Vec3> impulses() const;
  // After a pass: x_end, m, and j, N s, one each a node. True when another pass is needed; false at
  // the fixed point or at max_passes.
  bool update(std::span<const Vec3> x_end, std::span<const Vec3> constraint_impulse);
  // After the last pass: moves nodes (without pins) that end inside by more than the tolerance
  // above to the surface and returns how many. Keeps the contacts for the next step.
  Index finish(std::span<Vec3> x_end);
  // The two halves of finish: a step that is given up in between has changed nothing that lasts.
  Index move_out(std::span<Vec3> x_end);
  void keep();

  // Between begin_step and the next: the first solid in which the node would end deeper than the
  // tolerance above, moving from where it started to x_end; null if there is none.
  std::optional<Obstacle> obstacle(Index node, const Vec3& x_end) const;
  // The planes of all contacts for nodes that end at x_end, by node.
  std::vector<std::pair<Index, Obstacle>> touched(std::span<const Vec3> x_end) const;

  std::span<const Solid> solids() const { return solids_; }
  // Another motion of the same solid, between steps.
  void set_solid(std::size_t k, const Solid& solid) { solids_[k] = solid; }
  Index nodes() const { return nodes_; }
  int contacts() const { return static_cast<int>(contacts_.size()); }
  int sticking() const;  // nodes
  int passes() const { return counts_.passes; }
  double deepest() const { return counts_.deepest; }
  const ContactCounts& counts() const { return counts_; }

  // As of the last finish: a run that restores it goes on to the same bits. restore throws
  // InputError on a state that does not fit.
  const ContactState& state() const { return kept_; }
  void restore(ContactState state);

 private:
  struct Contact {
    Index node = 0;
    Index solid = 0;
    Vec3 anchor = Vec3::Zero();  // local, on the surface
    Vec3 target = Vec3::Zero();  // m, world: where the anchor ends
    Vec3 normal = Vec3::UnitZ();
    double distance = 0.0;  // m: n·(x_end - x_start)
    double lambda = 0.0;    // N s
    Index kept = -1;        // its entry in the state of the step before
    bool fresh = true;
    bool stays = false;
    bool released = false;
  };
  // A node in contact, with contacts_[first] ... contacts_[first + count - 1].
  struct TouchedNode {
    Index node = 0;
    Index first = 0;
    Index count = 0;
    bool fresh = true;
    bool sticking = false;
    bool turned = false;           // from stick to slide, in this pass
    bool turned_loose = false;     // that, in this step
    bool holds = false;            // slides, but friction would stop it
    int updates = 0;               // of friction, in this step
    int wait = 0;                  // steps until it may stick
    int longest = 0;               // the last such wait
    bool floats = false;           // its planes must be made anew
    int renewals = 0;              // passes asked for because of that, in this step
    double hold = 0.0;             // N s: sum mu lambda
    Vec3 friction = Vec3::Zero();  // N s
    double change = 0.0;           // N s: what this pass changed in it
    // m/(N s): slip that friction takes away; 0 if not known yet
    double compliance = 0.0;
    Vec3 last_friction = Vec3::Zero();  // of the pass before
    std::optional<Vec3> last_slip;      // m
  };
  struct Normals;

  std::span<Contact> of(const TouchedNode& touched) {
    return {contacts_.data() + touched.first, static_cast<std::size_t>(touched.count)};
  }
  std::span<const Contact> of(const TouchedNode& touched) const {
    return {contacts_.data() + touched.first, static_cast<std::size_t>(touched.count)};
  }
  bool may_meet(std::size_t solid, Index node) const {
    return meets_[solid].empty() || meets_[solid][node];
  }
  const SolidStep& step_of(const Contact& contact) const {
    return steps_[static_cast<std::size_t>(contact.solid)];
  }
  bool has_friction(const TouchedNode& touched) const;
  const Contact& holder(const TouchedNode& touched) const;
  Normals normals_of(const TouchedNode& touched) const;
  Mat3 free_of_pins(Index node) const;

  Contact contact_at(Index node, Index solid, const Vec3& x_end, double touch_tolerance) const;
  void keep_contacts(double h, std::span<const Vec3> x_predicted);
  template <class Meets>
  int add_met(std::span<const Vec3> x_end, const Meets& meets);
  int add_predicted(std::span<const Vec3> x_predicted);
  bool add_inside(std::span<const Vec3> x_end);
  bool drop_released();
  void group();
  Obstacle obstacle(const SolidStep& step, Index node, const Vec3& x_end) const;
  void recall(TouchedNode& touched, std::size_t kept) const;
  double depth_tolerance(const SolidStep& step) const;
  void renew_planes(std::span<const Vec3> x_end);
  void renew_planes(TouchedNode& touched, const Vec3& x_end);

  Vec3 slip_of(const Contact& contact, const Normals& normals, const Vec3& x_end) const;
  bool rides(const TouchedNode& touched, const Normals& normals, const Vec3& x_end) const;
  double hold_of(const TouchedNode& touched) const;
  Vec3 sliding_friction(const TouchedNode& touched, const Normals& normals, const Vec3& x_end,
                        const Vec3& taken) const;
  Vec3 renewed_friction(const TouchedNode& touched, const Normals& normals,
                        const Vec3& x_end) const;
  void start_fresh(std::span<const Vec3> x_end);
  void judge(TouchedNode& touched, const Vec3& x_end, const Vec3& impulse, double negligible);
  void judge_stick(TouchedNode& touched, const Vec3& tangential, double negligible);
  void judge_slide(TouchedNode& touched, const Normals& normals, const Vec3& x_end);
  static void learn_compliance(TouchedNode& touched, const Vec3& slip);
  void fill_impulses();
  void settle(TouchedNode& touched);
  bool move_out(Index node, Vec3& x_end, double& depth) const;
  void remember();

  std::vector<Solid> solids_;
  std::vector<std::vector<std::uint8_t>> meets_;
  ContactOptions options_;
  Index nodes_;
  double h_ = 0.0;
  std::vector<SolidStep> steps_;  // one a solid
  std::vector<Vec3> start_;       // m: x at t
  std::vector<std::int8_t> pin_ndof_;
  std::vector<std::pair<Index, Mat3>> partial_pins_;  // S of nodes with ndof 1 or 2, by node
  std::vector<Contact> contacts_;                     // by node, then solid
  std::vector<TouchedNode> touched_;                  // by node
  std::map<std::pair<Index, Index>, int> releases_;   // (node, solid) -> how often in this step
  std::vector<Vec3> impulses_;                        // one a node, if any slides with friction
  std::vector<std::uint8_t> met_;
  ContactCounts counts_;
  ContactState kept_;
};

}  // namespace taut
