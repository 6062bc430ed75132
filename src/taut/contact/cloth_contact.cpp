#include "taut/contact/cloth_contact.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <set>

#include "taut/base/parallel.h"
#include "taut/base/timer.h"
#include "taut/contact/angular_momentum.h"
#include "taut/contact/impulses.h"
#include "taut/contact/repulsion.h"

namespace taut {

namespace {

constexpr double separation_share = 1e-2;  // of the thickness: what is surely kept
constexpr double gap_share = 0.5;          // of the thickness: where colliding pairs should end
constexpr double tolerance_share = 1e-3;   // of the thickness: rows this well met are met
constexpr int repulsion_iterations = 8, impulse_iterations = 6;
// from then on colliding pairs need to end only half as far apart, and again
constexpr int full_sweeps = 4;
constexpr int most_zone_rounds = 1000;
// of the thickness: how well a zone has to fit what it is attached to
constexpr double fit_share = 0.1;
constexpr Index vertex_grain = 2048;

struct Trouble {
  std::vector<CollidingPair> pairs;
  std::vector<std::pair<Index, Obstacle>> obstacles;
  bool none() const { return pairs.empty() && obstacles.empty(); }
};

}  // namespace

struct ClothContact::Work {
  const ClothContactStep& step;
  std::span<Vec3> x1;
  RigidZones zones;
  std::vector<ContactRow>& rows;  // in the places of slabs, then those of collisions
  std::optional<RowSlabs> slabs;
  Trouble trouble;
  std::vector<std::uint8_t> moved;  // since the last search
  std::vector<std::uint8_t> awake;  // for the rows that are to be met

  std::span<const double> mass;

  Work(const ClothContactStep& the_step, std::span<Vec3> end, std::span<const double> masses,
       std::vector<ContactRow>& the_rows)
      : step(the_step),
        x1(end),
        zones(masses, the_step.held),
        rows(the_rows),
        moved(end.size()),
        awake(end.size(), 1),
        mass(masses) {}

  void meet_rows(int iterations, double tolerance) {
    satisfy_rows(rows, *slabs, x1, awake, moved, iterations, tolerance);
    restore_angular_momentum(rows, mass, step.inverse_mass, step.lever, x1, moved);
    parallel_for(static_cast<Index>(rows.size()), vertex_grain, [&](Index begin, Index end) {
      for (Index k = begin; k < end; ++k) rows[k].pushed.setZero();
    });
    std::ranges::fill(awake, std::uint8_t{0});
  }
  void forget_moved() { std::ranges::fill(moved, std::uint8_t{0}); }
};

ClothContact::ClothContact(CollisionSurface surface, std::vector<CollisionBody> bodies,
                           std::span<const Vec3> start, std::vector<double> mass,
                           ContactOptions options)
    : surface_(std::make_unique<CollisionSurface>(std::move(surface))),
      bodies_(std::move(bodies)),
      mass_(std::move(mass)),
      options_(std::move(options)),
      laws_(options_, bodies_),
      separation_(separation_share * std::min(options_.thickness, laws_.smallest_thickness())),
      search_(*surface_, start) {}

// The first node is of one of the two bodies, the last of the other.
const PairLaw& ClothContact::law_of(const CollisionPair& pair) const {
  return laws_.of(surface_->body[pair.node.front()], surface_->body[pair.node.back()]);
}

bool ClothContact::meets_solid(const CollisionPair& pair) const {
  return surface_->is_solid[pair.node.front()] || surface_->is_solid[pair.node.back()];
}

Status ClothContact::resolve(const ClothContactStep& step, std::span<Vec3> x1) {
  counts_ = {};
  zones_ = {};
  forces_.clear();
  trouble_.clear();
  search_.reset_count();
  Work work(step, x1, mass_, rows_);
  repel(work);
  bool settled = false;
  for (int round = 0; round <= options_.sweeps && !settled; ++round) settled = sweep(work, round);
  Status status;
  if (!settled) status = hold(work);
  note(work);
  return status;
}

void ClothContact::repel(Work& work) {
  Timer timer;
  const std::vector<NearPair> near =
      search_.near(work.step.x0, work.x1, laws_.largest_thickness(),
                   [&](const CollisionPair& pair) { return thickness_of(pair); });
  counts_.near = static_cast<int>(near.size());
  const std::vector<ContactRow> touched = touched_rows(work);
  std::vector<RowSlabs::Vertices> vertices;
  vertices.reserve(near.size() + touched.size());
  for (const NearPair& pair : near) vertices.push_back(pair.pair.node);
  for (const ContactRow& row : touched) vertices.push_back(row.node);
  work.slabs.emplace(vertices, work.step.x0);
  work.rows.resize(vertices.size());
  const PairForces forces(work.step.forces, surface_->vertices);
  parallel_for(static_cast<Index>(vertices.size()), vertex_grain, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) {
      ContactRow& row = work.rows[work.slabs->place(k)];
      row = k < std::ssize(near)
                ? repulsion_row(near[k], thickness_of(near[k].pair), friction_of(near[k].pair))
                : touched[k - near.size()];
      weigh(row, work.step.inverse_mass, work.step.x0);
      if (k < std::ssize(near)) begin_with(row, forces.of(row.node), work.step.h);
    }
  });
  counts_.near_ms += timer.lap();
  apply_impulses(work.rows, *work.slabs, work.x1, work.moved);
  work.meet_rows(repulsion_iterations, tolerance_share * options_.thickness);
  counts_.impulse_ms += timer.lap();
}

// Nodes that touch analytic solids. Where the solve has put them they are well placed, even if a
// little inside (solid_contact.h): pushes must not take them further in.
std::vector<ContactRow> ClothContact::touched_rows(const Work& work) const {
  std::vector<ContactRow> rows;
  if (!work.step.solids) return rows;
  for (const auto& [node, obstacle] : work.step.solids->touched(work.x1)) {
    if (work.step.held[node]) continue;
    ContactRow& row = rows.emplace_back(obstacle_row(node, obstacle, work.step.x0[node]));
    row.target = std::min(row.target, row.normal.dot(work.x1[node]));
  }
  return rows;
}

// Collisions of the pairs with a node in `moved` (all, where it is empty),
// and those nodes' obstacles.
void ClothContact::find_trouble(Work& work, std::span<const std::uint8_t> moved) {
  const auto skip = [&](const CollisionPair& pair) {
    return ignored(pair) || work.zones.together(pair.node);
  };
  work.trouble.pairs = search_.colliding(work.step.x0, work.x1, separation_, moved, skip);
  work.trouble.obstacles.clear();
  if (!work.step.solids || work.step.solids->solids().empty()) return;
  const Index nodes = work.step.solids->nodes();
  std::vector<std::uint8_t> blocked(static_cast<std::size_t>(nodes), 0);
  parallel_for(nodes, vertex_grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      blocked[i] = !work.step.held[i] && (moved.empty() || moved[i]) &&
                   work.step.solids->obstacle(i, work.x1[i]);
  });
  for (Index i = 0; i < nodes; ++i) {
    if (!blocked[i]) continue;
    const Obstacle obstacle = *work.step.solids->obstacle(i, work.x1[i]);
    if (!work.zones.rides(i, obstacle.solid)) work.trouble.obstacles.emplace_back(i, obstacle);
  }
}

// True when nothing was found.
bool ClothContact::sweep(Work& work, int round) {
  Timer timer;
  find_trouble(work, round == 0 ? std::span<const std::uint8_t>() : work.moved);
  counts_.detect_ms += timer.lap();
  work.forget_moved();
  if (work.trouble.none()) return true;
  counts_.impacts += static_cast<int>(work.trouble.pairs.size());
  if (round == options_.sweeps) return false;
  ++counts_.sweeps;
  double share = gap_share;
  for (int k = full_sweeps; k <= round; ++k) share = std::max(0.5 * share, 3.0 * separation_share);
  for (const CollidingPair& hit : work.trouble.pairs) {
    const double thickness = thickness_of(hit.pair),
                 start = closest(hit.pair, work.step.x0).distance;
    const double gap = std::min(share * thickness, start + parting_share * thickness);
    work.rows.push_back(impact_row(hit, work.step.x0, work.x1, gap, friction_of(hit.pair)));
    weigh(work.rows.back(), work.step.inverse_mass, work.step.x0);
  }
  for (const auto& [node, obstacle] : work.trouble.obstacles) {
    work.rows.push_back(obstacle_row(node, obstacle, work.step.x0[node]));
    weigh(work.rows.back(), work.step.inverse_mass, work.step.x0);
  }
  // What could not be moved still collides, and must be found again.
  for (const CollidingPair& hit : work.trouble.pairs)
    for (const Index node : hit.pair.node) work.moved[node] = work.awake[node] = 1;
  for (const auto& [node, obstacle] : work.trouble.obstacles)
    work.moved[node] = work.awake[node] = 1;
  work.meet_rows(impulse_iterations, tolerance_share * options_.thickness);
  counts_.impulse_ms += timer.lap();
  return false;
}

Status ClothContact::hold(Work& work) {
  Timer timer;
  const double tolerance = fit_share * options_.thickness;
  Status status;
  while (!work.trouble.none() && status.ok()) {
    ++counts_.zone_rounds;
    bool grown = false;
    for (const CollidingPair& hit : work.trouble.pairs)
      grown |= work.zones.join(hit.pair.node, work.step.x0, work.x1);
    for (const auto& [node, obstacle] : work.trouble.obstacles)
      grown |= work.zones.attach(node, obstacle.solid, work.step.x0[node], obstacle.carried);
    if (!grown || counts_.zone_rounds > most_zone_rounds) {
      status = stuck(work);
      break;
    }
    if (const RigidZone* zone = work.zones.move(work.step.x0, work.x1, tolerance, work.moved)) {
      status = contradiction(work, *zone);
      break;
    }
    find_trouble(work, work.moved);
    work.forget_moved();
  }
  counts_.zone_ms += timer.lap();
  return status;
}

void ClothContact::note_touched(const Work& work) {
  touched_.assign(mass_.size(), 0);
  for (const ContactRow& row : work.rows) {
    if (!(row.lambda > 0.0)) continue;
    const bool plane = row.node[1] < 0;
    const bool solid = plane || std::ranges::any_of(row.node, [&](Index node) {
                         return surface_->is_solid[node] != 0;
                       });
    for (std::size_t k = 0; k < row.node.size(); ++k)
      if (row.node[k] >= 0 && row.weight[k] != 0.0)
        touched_[row.node[k]] |= solid ? touched_solid : touched_cloth;
  }
}

void ClothContact::note(const Work& work) {
  note_touched(work);
  counts_.tested = search_.tested();
  forces_ = forces_of(work.rows, work.step.h, surface_->vertices);
  counts_.pushing = static_cast<int>(
      std::ranges::count_if(work.rows, [](const ContactRow& row) { return row.lambda > 0.0; }));
  counts_.zones = static_cast<int>(work.zones.zones().size());
  counts_.zone_nodes = work.zones.node_count();
  counts_.inexact = work.zones.inexact();
  std::vector<std::pair<Index, std::uint8_t>> nodes;
  for (const auto& [first, zone] : work.zones.zones()) {
    counts_.largest_zone = std::max(counts_.largest_zone, static_cast<int>(zone.nodes.size()));
    for (const Index node : zone.nodes) nodes.emplace_back(node, !zone.attachments.empty());
  }
  std::ranges::sort(nodes);
  for (const auto& [node, rides] : nodes) {
    zones_.node.push_back(node);
    zones_.rides.push_back(rides);
  }
}

std::string ClothContact::place(Index vertex, const Vec3& x) const {
  const CollisionBody& body = bodies_[surface_->body[vertex]];
  Index first = vertex;
  while (first > 0 && surface_->body[first - 1] == surface_->body[vertex]) --first;
  return fmt::format("{} '{}' {} {} at ({:.4f}, {:.4f}, {:.4f})", body.is_solid ? "solid" : "cloth",
                     body.name, body.is_solid ? "vertex" : "node", vertex - first, x.x(), x.y(),
                     x.z());
}

Status ClothContact::unresolved(const Work& work, std::span<const Index> nodes,
                                const std::string& why) {
  trouble_.assign(nodes.begin(), nodes.end());
  std::vector<std::string> places;
  for (const Index node : nodes) places.push_back(place(node, work.step.x0[node]));
  return {Outcome::breakdown, fmt::format("contact: {} {}", fmt::join(places, ", "), why)};
}

// Nothing is left to merge or attach, and still there is a collision: with what holds its zone, or
// between held nodes.
Status ClothContact::stuck(const Work& work) {
  std::vector<Index> nodes;
  if (!work.trouble.pairs.empty()) {
    const auto& pair = work.trouble.pairs.front().pair.node;
    nodes.assign(pair.begin(), pair.end());
  } else {
    nodes.push_back(work.trouble.obstacles.front().first);
  }
  for (const Index node : nodes)
    if (const RigidZone* zone = work.zones.zone_of(node); zone && !zone->attachments.empty())
      return contradiction(work, *zone);
  return unresolved(work, nodes, "cannot be kept apart");
}

Status ClothContact::contradiction(const Work& work, const RigidZone& zone) {
  std::set<std::string> holders;
  for (const ZoneAttachment& attachment : zone.attachments) {
    if (attachment.holder < 0) {
      holders.insert("solid '" + work.step.solids->solids()[-1 - attachment.holder].name + "'");
    } else {
      const CollisionBody& body = bodies_[surface_->body[attachment.holder]];
      holders.insert(body.is_solid ? "solid '" + body.name + "'"
                                   : "pins of cloth '" + body.name + "'");
    }
  }
  const std::size_t shown = std::min<std::size_t>(zone.nodes.size(), 4);
  Status status =
      unresolved(work, std::span(zone.nodes).first(shown),
                 fmt::format("and {} more nodes are pinched between {}, which do not move alike",
                             zone.nodes.size() - shown, fmt::join(holders, " and ")));
  trouble_ = zone.nodes;
  return status;
}

double default_thickness(const CollisionSurface& surface, std::span<const Vec3> rest) {
  constexpr double share = 0.1, most = 1e-3;
  double length = 0.0;
  Index count = 0;
  for (const EdgeVertices& edge : surface.edges) {
    if (surface.is_solid[edge[0]]) continue;
    length += (rest[edge[0]] - rest[edge[1]]).norm();
    ++count;
  }
  return count > 0 ? std::min(most, share * length / count) : most;
}

}  // namespace taut
