#pragma once
// Rigid impact zones: nodes that impulses could not keep apart move as one rigid body over the step
// (Provot 1997; Bridson, Fedkiw & Anderson 2002, section 7.4; paper Section 7). The last resort: it
// holds since nothing meets inside a body that moves rigidly.
//
//   zone           nodes joined by pairs that collide; zones that share a pair merge
//   attachment     a point that the zone must carry along: a held node (pinned, or of a solid's
//                  mesh), from where it is at the start to where it ends; or a node that would end
//                  inside an analytic solid, which then rides with it
//   contradiction  attachments that no rigid motion fits: the zone is pinched
//
// Attachments count as infinitely heavy: a zone that has some moves as they do, and keeps no
// momentum; one that has none keeps linear and angular momentum (contact/rigid_motion.h). Held
// nodes join no zone: two zones on one solid stay two.

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "taut/contact/rigid_motion.h"

namespace taut {

struct ZoneAttachment {
  Index holder = 0;  // a held node >= 0, or an analytic solid s as -1 - s
  Index node = 0;    // the node that rides, for a solid; else the holder
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
};

struct RigidZone {
  std::vector<Index> nodes;  // ascending
  std::vector<ZoneAttachment> attachments;
  bool changed = true;  // since it was moved
};

class RigidZones {
 public:
  // mass: kg, one a node. held: not 0 where a node's motion is given.
  RigidZones(std::span<const double> mass, std::span<const std::uint8_t> held)
      : mass_(mass), held_(held) {}

  // Joins the free nodes and attaches the held ones. False: all of that was so already.
  bool join(std::span<const Index> nodes, std::span<const Vec3> x0, std::span<const Vec3> x1);
  // The node (in a zone or not yet) rides with a solid, which would carry it to `to`. False: it
  // does so already.
  bool attach(Index node, Index solid, const Vec3& from, const Vec3& to);
  // Moves the nodes of changed zones and marks them in `moved`. What attachments fit to within
  // `tolerance` (m) is no contradiction. Returns the first zone (by its least node) whose
  // attachments contradict each other, or null; it is not moved.
  const RigidZone* move(std::span<const Vec3> x0, std::span<Vec3> x1, double tolerance,
                        std::span<std::uint8_t> moved);

  // Are these nodes all in one zone (no held one among them)?
  bool together(std::span<const Index> nodes) const;
  const std::map<Index, RigidZone>& zones() const { return zones_; }
  Index node_count() const;
  // motions that turned by more than momentum-keeping motions can
  int inexact() const { return inexact_; }
  bool contains(Index node) const { return zone_of_.contains(node); }
  // The zone that a node is in, or null.
  const RigidZone* zone_of(Index node) const;
  // Is the node in a zone that rides with this solid?
  bool rides(Index node, Index solid) const;

 private:
  Index zone_with(Index node);
  Index merge(Index a, Index b);
  bool move(RigidZone& zone, std::span<const Vec3> x0, std::span<Vec3> x1, double tolerance,
            std::span<std::uint8_t> moved);

  std::span<const double> mass_;
  std::span<const std::uint8_t> held_;
  std::map<Index, RigidZone> zones_;  // by its first node
  std::map<Index, Index> zone_of_;    // of nodes in zones
  int inexact_ = 0;
};

}  // namespace taut
