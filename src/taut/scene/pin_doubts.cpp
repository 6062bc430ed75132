#include <algorithm>
#include <cmath>

#include "taut/scene/doubts.h"
#include "taut/scene/scene_world.h"

namespace taut {

namespace {

bool moves(const Pin& pin) {
  return std::ranges::any_of(pin.key_frames, [&](const KeyFrame& key) {
    return !(key.pose == pin.key_frames.front().pose);
  });
}

// Of a node at x between two key frames, at most, m/s.
double speed_between(const KeyFrame& a, const KeyFrame& b, const Vec3& from_pivot) {
  const double way = (b.pose.translation - a.pose.translation).norm();
  return (way + a.pose.rotation.angularDistance(b.pose.rotation) * from_pivot.norm()) /
         (b.time - a.time);
}

double top_speed(const Pin& pin, const std::vector<Index>& nodes, const TriangleMesh& shape,
                 double end) {
  double speed = 0.0;
  for (std::size_t k = 1; k < pin.key_frames.size(); ++k) {
    const KeyFrame &a = pin.key_frames[k - 1], &b = pin.key_frames[k];
    if (b.time <= 0.0 || a.time >= end || (pin.release >= 0.0 && a.time >= pin.release)) continue;
    for (const Index node : nodes)
      speed = std::max(
          speed, speed_between(a, b, shape.positions[static_cast<std::size_t>(node)] - pin.pivot));
  }
  return speed;
}

// A row of nodes whose end is pulled with speed v from rest: its first spring stretches to v/c, c =
// L sqrt(k/m) the speed of sound in the row. That is the same in small steps as in nature; in a
// long step backward Euler spreads it, and the strain is (v h / L)(1 - r) with r + 1/r = 2 + m/(h²
// k).
double strain_of_pull(double speed, double h, const Cloth& cloth, const ClothEstimate& e) {
  const double a = e.node_mass / (h * h * cloth.material.k_stretch);
  const double r = 1.0 + 0.5 * a - std::sqrt(a + 0.25 * a * a);
  return speed * h / e.spacing * (1.0 - r);
}

void doubt_pull(Doubts& d, const Cloth& cloth, const Pin& pin, const std::vector<Index>& nodes,
                const TriangleMesh& shape, const ClothEstimate& e) {
  constexpr double torn = 0.5;
  const TimeOptions& time = d.scene.time;
  const double speed = top_speed(pin, nodes, shape, time.frames * time.steps_per_frame * time.step);
  if (speed == 0.0 || !(cloth.material.k_stretch > 0.0)) return;
  const double strain = strain_of_pull(speed, time.step, cloth, e);
  if (strain > torn)
    d.add(
        "a pin of cloth '{}' (node {}) moves {:.3g} m in a time step, at {:.3g} m/s: the cloth "
        "beside it cannot follow and will stretch by "
        "about {:.0f} %; "
        "give its key frames more time, {:.2g} times as much, or raise k_stretch",
        cloth.name, nodes.front(), speed * time.step, speed, 100.0 * strain,
        std::ceil(strain / 0.05));
}

void doubt_still_path(Doubts& d, const Cloth& cloth, const Pin& pin, Index node) {
  if (!pin.key_frames.empty() && !moves(pin))
    d.add(
        "the key frames of a pin of cloth '{}' (node {}) move nothing: a path is the displacement "
        "since time 0; give it at least two that "
        "differ, "
        "the first at time = 0",
        cloth.name, node);
}

void doubt_two_pins(Doubts& d, const Cloth& cloth, const std::vector<std::vector<Index>>& nodes) {
  const auto same_path = [](const Pin& a, const Pin& b) {
    return (!moves(a) && !moves(b)) || (a.key_frames == b.key_frames && a.pivot == b.pivot);
  };
  for (std::size_t b = 1; b < nodes.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      std::vector<Index> both;
      std::ranges::set_intersection(nodes[a], nodes[b], std::back_inserter(both));
      if (both.empty() || same_path(cloth.pins[a], cloth.pins[b])) continue;
      d.add(
          "cloth '{}': pins {} and {} (from 0) both hold node {}{} but move differently; the later "
          "one rules: take the node out of one of "
          "them",
          cloth.name, a, b, both.front(),
          both.size() > 1 ? fmt::format(" and {} more", both.size() - 1) : "");
      return;
    }
}

void doubt_pins_inside(Doubts& d, const Cloth& cloth, const TriangleMesh& shape) {
  const std::vector<bool> pinned = pinned_at_start(cloth, shape.positions.size());
  for (const Solid& solid : d.scene.solids) {
    std::size_t inside = 0, first = 0;
    double deepest = 0.0;
    for (std::size_t i = pinned.size(); i-- > 0;) {
      const double depth = pinned[i] ? depth_inside(solid, shape.positions[i], 0.0) : 0.0;
      if (depth <= d.scene.contact.touch_tolerance) continue;
      ++inside, first = i;
      deepest = std::max(deepest, depth);
    }
    if (inside > 0)
      d.add(
          "{} of cloth '{}', held by a pin, {} inside solid '{}', up to {:.3g} m deep: pin and "
          "solid will tear the cloth between them; "
          "move the pin "
          "or the solid (--untangle moves neither)",
          inside == 1 ? fmt::format("node {}", first)
                      : fmt::format("node {} and {} more", first, inside - 1),
          cloth.name, inside == 1 ? "starts" : "start", solid.name, deepest);
  }
}

}  // namespace

std::vector<bool> pinned_at_start(const Cloth& cloth, std::size_t nodes) {
  std::vector<bool> pinned(nodes, false);
  for (const Pin& pin : cloth.pins)
    for (const Index node : selected_nodes(cloth, pin.where))
      if (node >= 0 && static_cast<std::size_t>(node) < nodes)
        pinned[static_cast<std::size_t>(node)] = true;
  return pinned;
}

void doubt_pins(Doubts& d, const Cloth& cloth, const TriangleMesh& shape, const ClothEstimate& e) {
  std::vector<std::vector<Index>> nodes;
  for (const Pin& pin : cloth.pins) {
    std::vector<Index>& held = nodes.emplace_back(selected_nodes(cloth, pin.where));
    // What does not exist is an error, found when the cloth is built.
    std::erase_if(
        held, [&](Index node) { return static_cast<std::size_t>(node) >= shape.positions.size(); });
    if (held.empty()) continue;
    doubt_pull(d, cloth, pin, held, shape, e);
    doubt_still_path(d, cloth, pin, held.front());
  }
  doubt_two_pins(d, cloth, nodes);
  doubt_pins_inside(d, cloth, shape);
}

}  // namespace taut
