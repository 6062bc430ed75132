#include "taut/contact/angular_momentum.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <numeric>

#include "taut/base/collect.h"

namespace taut {

namespace {

bool has_pushed(const ContactRow& row) { return row.pushed != Vec3::Zero(); }
bool touches_solid(const ContactRow& row) { return row.node[1] < 0; }

// A row that has pushed or touches a solid, which few do. Kept apart, since a row has many bytes
// and these are looked at several times.
struct Push {
  Index row;
  std::array<Index, 4> node;
};

std::vector<Push> pushes_of(std::span<const ContactRow> rows) {
  constexpr Index rows_per_task = 2048;
  std::vector<Push> pushes;
  collect(
      static_cast<Index>(rows.size()), rows_per_task,
      [&](Index begin, Index end, std::vector<Push>& found) {
        for (Index k = begin; k < end; ++k)
          if (has_pushed(rows[k]) || touches_solid(rows[k])) found.push_back({k, rows[k].node});
      },
      pushes);
  return pushes;
}

// Nodes that rows have joined. One entry a vertex of the surface: cheaper than to look up the few.
class Islands {
 public:
  Islands(std::span<const Push> pushes, std::span<const double> inverse_mass)
      : parent_(inverse_mass.size()), attached_(parent_.size()) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
    for (const Push& push : pushes) add(push.node, inverse_mass);
  }
  Index island(Index node) {
    while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
    return node;
  }
  bool is_attached(Index node) { return attached_[island(node)] != 0; }

 private:
  void add(const std::array<Index, 4>& nodes, std::span<const double> inverse_mass) {
    if (nodes[1] < 0) {
      attached_[island(nodes[0])] = 1;
      return;
    }
    Index free = -1;
    bool attached = false;
    for (const Index node : nodes) {
      attached |= inverse_mass[node] == 0.0;
      if (inverse_mass[node] == 0.0) continue;
      if (free >= 0) join(free, node);
      free = node;
    }
    assert(free >= 0);
    if (attached) attached_[island(free)] = 1;
  }
  // The one with the least node is kept, so that the order of islands does
  // not depend on that of rows.
  void join(Index a, Index b) {
    const Index p = island(a), q = island(b), kept = std::min(p, q), lost = std::max(p, q);
    parent_[lost] = kept;
    attached_[kept] |= attached_[lost];
  }

  std::vector<Index> parent_;
  std::vector<std::uint8_t> attached_;
};

struct Turn {
  double mass = 0.0;
  Vec3 centre = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
  Vec3 missing = Vec3::Zero();  // kg m²
  Vec3 angle = Vec3::Zero();    // rad
};

// Two points have no inertia about their line, nor can rows between them add momentum about it: the
// least of the solutions.
Vec3 least_angle(const Turn& turn) {
  Eigen::CompleteOrthogonalDecomposition<Mat3> decomposition;
  decomposition.setThreshold(1e-10);
  const Vec3 angle = decomposition.compute(turn.inertia).solve(turn.missing);
  return angle.allFinite() ? angle : Vec3(Vec3::Zero());
}

}  // namespace

void restore_angular_momentum(std::span<const ContactRow> rows, std::span<const double> mass,
                              std::span<const double> inverse_mass, std::span<const Vec3> lever,
                              std::span<Vec3> x1, std::span<std::uint8_t> moved) {
  const std::vector<Push> pushes = pushes_of(rows);
  if (pushes.empty()) return;
  Islands islands(pushes, inverse_mass);
  std::vector<Index> turn_of(lever.size(), -1);  // of islands, at their least node
  std::vector<Turn> turns;
  std::vector<std::pair<Index, Index>> members;  // node and its turn
  const auto add = [&](const Push& push) {
    if (push.node[1] < 0) return;
    const auto free =
        std::ranges::find_if(push.node, [&](Index node) { return inverse_mass[node] > 0.0; });
    const Index island = islands.island(*free);
    if (islands.is_attached(island)) return;
    if (turn_of[island] < 0)
      turn_of[island] = static_cast<Index>(turns.size()), turns.emplace_back();
    turns[turn_of[island]].missing -=
        separation(rows[push.row], lever).cross(rows[push.row].pushed);
  };
  for (const Push& push : pushes) add(push);
  if (turns.empty()) return;
  for (Index node = 0; node < std::ssize(lever); ++node)
    if (const Index k = turn_of[islands.island(node)]; k >= 0) members.emplace_back(node, k);
  for (const auto& [node, k] : members) {
    turns[k].mass += mass[node];
    turns[k].centre += mass[node] * lever[node];
  }
  for (Turn& turn : turns) turn.centre /= turn.mass;
  for (const auto& [node, k] : members) {
    const Vec3 r = lever[node] - turns[k].centre;
    turns[k].inertia += mass[node] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
  }
  for (Turn& turn : turns) turn.angle = least_angle(turn);
  for (const auto& [node, k] : members) {
    const Vec3 change = turns[k].angle.cross(lever[node] - turns[k].centre);
    if (change == Vec3::Zero()) continue;
    x1[node] += change;
    moved[node] = 1;
  }
}

}  // namespace taut
