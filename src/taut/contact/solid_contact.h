#pragma once
// Contact of cloth nodes with analytic solids as an active set of constraints (paper Eq. 3-6).
// Knows no integrator: hands over constraints and friction impulses, and judges the constraint
// impulses that come back.
//
//   constraint    n·(x_end - x_start) = distance, m: the node ends on a plane that touches the
//                 solid; a node that sticks ends where its solid carries it (ndof 0)
//   impulse       N s: friction of a sliding node, for the momentum equation of this pass
//   j             N s: constraint impulse on a node, (I - S)(A dv - b), as the solid pushes
//
//   begin_step; do { constrain; solve with impulses } while (update); finish
//
// One step at a time; one thread calls, loops run in parallel; the same bits for any number of
// threads. Parts: ContactSet, StickSlip, ContactMemory, SolidObstacles. docs/mathematics.md, 3.5
// and 3.6; docs/design/solid_contact.md says when contacts change and why that ends.

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "taut/constraint/constraint_set.h"
#include "taut/contact/contact_memory.h"
#include "taut/contact/contact_options.h"
#include "taut/contact/contact_set.h"
#include "taut/contact/solid_obstacles.h"

namespace taut {

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
  std::span<const Vec3> impulses() const { return impulses_; }
  // After a pass: x_end, m, and j, N s, one each a node. True when another pass is needed; false at
  // the fixed point or at max_passes.
  bool update(std::span<const Vec3> x_end, std::span<const Vec3> constraint_impulse);
  // After the last pass: moves nodes (without pins) that end inside by more than the depth
  // tolerance (solid_obstacles.h) to the surface and returns how many. Keeps the contacts for the
  // next step.
  Index finish(std::span<Vec3> x_end);
  // The two halves of finish: a step that is given up in between has changed nothing that lasts.
  Index move_out(std::span<Vec3> x_end);
  void keep();

  // Between steps: solid k moves as this one (key frames, initial pose, velocities) from the next
  // step on. Its shape is the same (asserted); thickness and friction stay as they are. Where the
  // pose at that time is another than before, the jump is not seen as motion.
  void set_solid(std::size_t k, const Solid& solid);

  // What surface contact asks, between begin_step and the next. obstacle: as SolidObstacles.
  std::optional<Obstacle> obstacle(Index node, const Vec3& x_end) const;
  // The planes of all contacts for nodes that end at x_end, by node.
  std::vector<std::pair<Index, Obstacle>> touched(std::span<const Vec3> x_end) const;
  const SolidObstacles& obstacles() const { return set_.obstacles(); }

  std::span<const Solid> solids() const { return obstacles().solids(); }
  Index nodes() const { return obstacles().nodes(); }
  int contacts() const { return static_cast<int>(set_.contacts().size()); }
  int sticking() const;  // nodes
  int passes() const { return counts_.passes; }
  double deepest() const { return counts_.deepest; }
  const ContactCounts& counts() const { return counts_; }

  // As of the last finish: a run that restores it goes on to the same bits. restore throws
  // InputError on a state that does not fit.
  const ContactState& state() const { return memory_.state(); }
  void restore(ContactState state);

 private:
  void start_friction(std::span<const Vec3> x_end);
  void judge(TouchedNode& touched, const Vec3& x_end, const Vec3& impulse, double negligible);
  void fill_impulses();

  ContactSet set_;
  ContactMemory memory_;  // as of the last finish
  int max_passes_;
  double h_ = 0.0;
  std::vector<Vec3> impulses_;  // one a node, if any slides with friction
  ContactCounts counts_;
};

}  // namespace taut
