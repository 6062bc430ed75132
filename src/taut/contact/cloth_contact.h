#pragma once
// What keeps cloth from passing through itself, other cloths and solids' meshes: corrects the
// positions at the end of a step so that no pair of the surface meets on the way, or says that it
// cannot (docs/mathematics.md, 7; docs/design/cloth-contact.md; Bridson, Fedkiw & Anderson 2002).
//
//   x0            m, positions at the start, without intersections
//   x1            m, where the dynamics would end; changed in place
//   thickness     m: how far apart layers keep when they can
//   separation    m: how far apart they surely stay
//
// Repulsion, then impulses, then rigid zones. At the end every pair has been proved free on its
// final way, or lies in one zone, inside which nothing can meet. The average velocities (x1 - x0)/h
// keep their linear and angular momentum, but for what pins and solids take and for zones counted
// as inexact. Deterministic: the same bits for any number of threads. One step at a time.

#include <memory>
#include <string>
#include <vector>

#include "taut/base/status.h"
#include "taut/contact/contact_options.h"
#include "taut/contact/pair_forces.h"
#include "taut/contact/pair_laws.h"
#include "taut/contact/pair_search.h"
#include "taut/contact/rigid_zones.h"
#include "taut/contact/solid_contact.h"

namespace taut {

struct ClothContactStep {
  std::span<const Vec3> x0;              // one each a vertex of the surface, like all that follows
  std::span<const Vec3> lever;           // m: y of contact/angular_momentum.h
  std::span<const double> inverse_mass;  // 1/kg, 0 for what is held
  std::span<const std::uint8_t> held;    // not 0: ends where x1 says
  // analytic ones, begun for this step; its nodes are the first vertices
  const SolidContact* solids = nullptr;
  double h = 1.0;                     // s: the unit of forces; any will do without them
  std::span<const PairForce> forces;  // of the step before, from forces(); empty: none known
};

struct ClothContactCounts {
  Offset tested = 0;  // pairs of the broad phase, of all passes
  int near = 0;       // pairs nearer than their thickness at the start
  int pushing = 0;    // rows with an impulse at the end
  int impacts = 0;    // collisions found on the way, in all sweeps
  int sweeps = 0;
  int zones = 0, zone_nodes = 0, largest_zone = 0;
  int zone_rounds = 0;
  int inexact = 0;  // zones that turned too far to keep all angular momentum
  double near_ms = 0.0, impulse_ms = 0.0, detect_ms = 0.0, zone_ms = 0.0;
};

// Nodes of zones, for the next solve: they go on with their velocity and are eliminated. Ascending.
struct ZoneState {
  std::vector<Index> node;
  // 1: with something held or a solid, so that gravity does not move it
  std::vector<std::uint8_t> rides;
  bool operator==(const ZoneState&) const = default;
};

// What the next step takes over from the last.
struct ClothContactState {
  ZoneState zones;
  std::vector<PairForce> forces;
  bool operator==(const ClothContactState&) const = default;
};

inline constexpr std::uint8_t touched_solid = 1, touched_cloth = 2;

class ClothContact {
 public:
  // start: m, one a vertex, any shape. mass: kg, one a vertex; of solids' vertices ignored.
  // thickness > 0: resolved, see default_thickness.
  ClothContact(CollisionSurface surface, std::vector<CollisionBody> bodies,
               std::span<const Vec3> start, std::vector<double> mass, ContactOptions options);

  // On failure x1 is not to be used, and the message says which nodes, cloths and
  // solids cannot be kept apart.
  Status resolve(const ClothContactStep& step, std::span<Vec3> x1);

  const CollisionSurface& surface() const { return *surface_; }
  const std::vector<CollisionBody>& bodies() const { return bodies_; }
  const ClothContactCounts& counts() const { return counts_; }
  const ContactOptions& options() const { return options_; }
  double separation() const { return separation_; }
  // Of the last resolve: the nodes that were in zones.
  const ZoneState& zone_state() const { return zones_; }
  // Of the last resolve: what pushed the pairs, ascending by their first vertex.
  const std::vector<PairForce>& forces() const { return forces_; }
  // Of the last resolve, one a vertex: who pushed it at the end, cloth (touched_cloth) or
  // a solid (touched_solid).
  std::span<const std::uint8_t> touched() const { return touched_; }
  // After a failure: the nodes that the message is about.
  const std::vector<Index>& trouble() const { return trouble_; }
  PairSearch& search() { return search_; }

 private:
  struct Work;
  bool ignored(const CollisionPair& pair) const { return !options_.self && !meets_solid(pair); }
  const PairLaw& law_of(const CollisionPair& pair) const;
  double thickness_of(const CollisionPair& pair) const {
    return ignored(pair) ? 0.0 : law_of(pair).thickness;
  }
  double friction_of(const CollisionPair& pair) const { return law_of(pair).friction; }
  bool meets_solid(const CollisionPair& pair) const;
  void repel(Work& work);
  std::vector<ContactRow> touched_rows(const Work& work) const;
  bool sweep(Work& work, int round);
  void find_trouble(Work& work, std::span<const std::uint8_t> moved);
  Status hold(Work& work);
  Status unresolved(const Work& work, std::span<const Index> nodes, const std::string& why);
  Status stuck(const Work& work);
  Status contradiction(const Work& work, const RigidZone& zone);
  std::string place(Index vertex, const Vec3& x) const;
  void note(const Work& work);
  void note_touched(const Work& work);

  std::unique_ptr<CollisionSurface> surface_;  // fixed in memory: the broad phase refers to it
  std::vector<CollisionBody> bodies_;
  std::vector<double> mass_;
  ContactOptions options_;
  PairLaws laws_;
  double separation_;
  PairSearch search_;
  ClothContactCounts counts_;
  ZoneState zones_;
  std::vector<PairForce> forces_;
  std::vector<ContactRow> rows_;  // of the last resolve; kept for its memory
  std::vector<std::uint8_t> touched_;
  std::vector<Index> trouble_;
};

// A tenth of the mean edge, at most 1 mm: less than what folding cloth can give
// way, more than rounding. m.
double default_thickness(const CollisionSurface& surface, std::span<const Vec3> rest);

}  // namespace taut
