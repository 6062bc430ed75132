#include "taut/contact/untangle_settle.h"

#include <algorithm>
#include <memory>

namespace taut {

namespace {

// Solids as they stand at the start.
std::vector<Solid> solids_at_rest(std::span<const Solid> solids) {
  std::vector<Solid> result(solids.begin(), solids.end());
  for (Solid& solid : result) {
    solid.initial = solid.pose(0.0);
    solid.key_frames.clear();
    solid.velocity = solid.angular_velocity = Vec3::Zero();
    solid.friction = 0.0;
  }
  return result;
}

// Rounds of contact's own response from a state without intersections: it never gets any.
class Settling {
 public:
  Settling(const UntangleInput& input, std::span<const LengthRange> ranges, std::span<const Vec3> x)
      : input_(input),
        ranges_(ranges),
        contact_(input.surface, smooth(input.bodies), x, masses(input.mass),
                 options(input.contact)) {
    Index nodes = 0;
    while (nodes < input.surface.vertices && !input.surface.is_solid[nodes]) ++nodes;
    pins_.reset(nodes);
    for (Index i = 0; i < nodes; ++i)
      if (input.held[i]) pins_.fix(i, Vec3::Zero());
    solids_ = std::make_unique<SolidContact>(solids_at_rest(input.solids), nodes, input.contact);
    for (Index v = 0; v < input.surface.vertices; ++v)
      inverse_mass_.push_back(input.held[v] ? 0.0 : 1.0 / input.mass[v]);
  }

  // False: the round failed, and x is as before.
  bool round(std::span<Vec3> x) {
    constexpr int length_iterations = 10;
    std::vector<Vec3> end(x.begin(), x.end());
    project_lengths(input_.surface, ranges_, input_.held, end, length_iterations);
    const auto nodes = static_cast<std::size_t>(pins_.nodes());
    solids_->begin_step(0.0, 1.0, std::span<const Vec3>(x).first(nodes),
                        std::span<const Vec3>(end).first(nodes), pins_);
    if (!contact_.resolve({x, x, inverse_mass_, input_.held, solids_.get(), 1.0, {}}, end).ok())
      return false;
    std::ranges::copy(end, x.begin());
    return true;
  }

  // The least distance of two features, at most the thickness. m.
  double gap(std::span<const Vec3> x) {
    const double thickness = input_.contact.thickness;
    double least = thickness;
    for (const NearPair& near :
         contact_.search().near(x, x, thickness, [&](const CollisionPair&) { return thickness; }))
      least = std::min(least, near.proximity.distance);
    return least;
  }

 private:
  static ContactOptions options(ContactOptions contact) {
    contact.self = true;
    contact.friction = 0.0;
    for (ContactPair& pair : contact.pairs) pair.friction = 0.0;
    return contact;
  }
  static std::vector<CollisionBody> smooth(std::span<const CollisionBody> bodies) {
    std::vector<CollisionBody> result(bodies.begin(), bodies.end());
    for (CollisionBody& body : result) body.friction = 0.0;
    return result;
  }
  static std::vector<double> masses(std::span<const double> mass) {
    return {mass.begin(), mass.end()};
  }

  const UntangleInput& input_;
  std::span<const LengthRange> ranges_;
  ClothContact contact_;
  ConstraintSet pins_;
  std::unique_ptr<SolidContact> solids_;
  std::vector<double> inverse_mass_;
};

}  // namespace

SettledQuality settle(const UntangleInput& input, std::span<const LengthRange> ranges,
                      const UntangleOptions& options, std::span<Vec3> x, int& rounds) {
  constexpr double enough_gap = 0.5;  // of the thickness
  constexpr double little_excess = 2e-3;
  Settling settling(input, ranges, x);
  SettledQuality quality{settling.gap(x), worst_excess(input.surface, ranges, x)};
  for (rounds = 0; rounds < options.most_rounds; ++rounds) {
    if (quality.gap >= enough_gap * input.contact.thickness && quality.excess <= little_excess)
      break;
    if (!settling.round(x)) break;
    quality = {settling.gap(x), worst_excess(input.surface, ranges, x)};
  }
  return quality;
}

}  // namespace taut
