#include "taut/sim/pinned_nodes.h"

#include <cassert>

namespace taut {

Vec3 PinnedNodes::target(std::size_t k, double time) const {
  if (!to.empty()) {
    if (time >= t1) return to[k];
    if (time <= t0) return from[k];
    const double share = (time - t0) / (t1 - t0);
    return (1.0 - share) * from[k] + share * to[k];
  }
  if (carrier.key_frames.empty()) return start[k];
  const Pose now = carrier.pose(time), origin = carrier.pose(0.0);
  return pivot + now.rotation * (origin.rotation.conjugate() * (start[k] - pivot)) +
         now.translation - origin.translation;
}

void PinnedNodes::move_to(std::vector<Vec3> places, double now) {
  assert(places.size() == nodes.size());
  std::vector<Vec3> here(nodes.size());
  for (std::size_t k = 0; k < here.size(); ++k) here[k] = target(k, now);
  from = std::move(here);
  to = std::move(places);
  t0 = t1 = now;
  awaits_step = true;
}

void PinnedNodes::begin_step(double time, double h) {
  if (!awaits_step) return;
  t0 = time;
  t1 = time + h;
}

}  // namespace taut
