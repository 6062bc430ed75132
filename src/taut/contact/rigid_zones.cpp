#include "taut/contact/rigid_zones.h"

#include <algorithm>
#include <utility>

namespace taut {

Index RigidZones::zone_with(Index node) {
  const auto [place, fresh] = zone_of_.try_emplace(node, node);
  if (fresh) zones_[node].nodes = {node};
  return place->second;
}

Index RigidZones::merge(Index a, Index b) {
  if (a == b) return a;
  const auto [kept, lost] = std::minmax(a, b);
  RigidZone& into = zones_.at(kept);
  RigidZone from = std::move(zones_.at(lost));
  zones_.erase(lost);
  for (const Index node : from.nodes) zone_of_[node] = kept;
  const auto middle = static_cast<std::ptrdiff_t>(into.nodes.size());
  into.nodes.insert(into.nodes.end(), from.nodes.begin(), from.nodes.end());
  std::inplace_merge(into.nodes.begin(), into.nodes.begin() + middle, into.nodes.end());
  for (const ZoneAttachment& attachment : from.attachments) {
    const auto same = [&](const ZoneAttachment& other) {
      return other.holder == attachment.holder && other.node == attachment.node;
    };
    if (std::ranges::none_of(into.attachments, same)) into.attachments.push_back(attachment);
  }
  into.changed = true;
  return kept;
}

bool RigidZones::join(std::span<const Index> nodes, std::span<const Vec3> x0,
                      std::span<const Vec3> x1) {
  Index zone = -1;
  bool changed = false;
  for (const Index node : nodes) {
    if (held_[node]) continue;
    changed |= !zone_of_.contains(node) || (zone >= 0 && zone_of_.at(node) != zone);
    zone = zone < 0 ? zone_with(node) : merge(zone, zone_with(node));
  }
  if (zone < 0) return false;
  RigidZone& joined = zones_.at(zone);
  for (const Index node : nodes) {
    if (!held_[node] || std::ranges::find(joined.attachments, node, &ZoneAttachment::holder) !=
                            joined.attachments.end())
      continue;
    joined.attachments.push_back({node, node, x0[node], x1[node]});
    changed = joined.changed = true;
  }
  return changed;
}

bool RigidZones::attach(Index node, Index solid, const Vec3& from, const Vec3& to) {
  RigidZone& zone = zones_.at(zone_with(node));
  const auto same = [&](const ZoneAttachment& other) {
    return other.holder == -1 - solid && other.node == node;
  };
  if (std::ranges::any_of(zone.attachments, same)) return false;
  zone.attachments.push_back({-1 - solid, node, from, to});
  zone.changed = true;
  return true;
}

const RigidZone* RigidZones::move(std::span<const Vec3> x0, std::span<Vec3> x1, double tolerance,
                                  std::span<std::uint8_t> moved) {
  for (auto& [first, zone] : zones_)
    if (std::exchange(zone.changed, false) && !move(zone, x0, x1, tolerance, moved)) return &zone;
  return nullptr;
}

bool RigidZones::move(RigidZone& zone, std::span<const Vec3> x0, std::span<Vec3> x1,
                      double tolerance, std::span<std::uint8_t> moved) {
  std::vector<Vec3> from, to;
  std::vector<double> mass;
  for (const ZoneAttachment& attachment : zone.attachments) {
    from.push_back(attachment.from);
    to.push_back(attachment.to);
  }
  std::optional<RigidMotion> motion;
  if (!from.empty()) {
    motion = motion_through(from, to, tolerance);
    if (!motion) return false;
  } else {
    for (const Index node : zone.nodes) {
      from.push_back(x0[node]);
      to.push_back(x1[node]);
      mass.push_back(mass_[node]);
    }
    motion = momentum_keeping_motion(from, to, mass);
    inexact_ += !motion->exact;
  }
  for (const Index node : zone.nodes) {
    x1[node] = (*motion)(x0[node]);
    moved[node] = 1;
  }
  return true;
}

bool RigidZones::together(std::span<const Index> nodes) const {
  Index zone = -1;
  for (const Index node : nodes) {
    const auto place = zone_of_.find(node);
    if (place == zone_of_.end() || (zone >= 0 && place->second != zone)) return false;
    zone = place->second;
  }
  return true;
}

const RigidZone* RigidZones::zone_of(Index node) const {
  const auto place = zone_of_.find(node);
  return place == zone_of_.end() ? nullptr : &zones_.at(place->second);
}

bool RigidZones::rides(Index node, Index solid) const {
  const RigidZone* zone = zone_of(node);
  return zone && std::ranges::find(zone->attachments, -1 - solid, &ZoneAttachment::holder) !=
                     zone->attachments.end();
}

Index RigidZones::node_count() const { return static_cast<Index>(zone_of_.size()); }

}  // namespace taut
