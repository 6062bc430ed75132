#pragma once
// The world's cloths as one system of nodes: positions, masses, springs, pins. Nodes of cloth c are
// first_node ... first_node + node_count - 1, in the order of its mesh.

#include <memory>

#include "taut/constraint/constraint_set.h"
#include "taut/element/external.h"
#include "taut/element/spring_model.h"
#include "taut/sim/pinned_nodes.h"
#include "taut/step/state.h"

namespace taut {

struct ClothPart {
  std::string name;
  Index first_node = 0, node_count = 0;
  Index first_triangle = 0, triangle_count = 0;
};

class ClothModel {
 public:
  // The world is a valid one. Throws InputError where two joined nodes lie in one place.
  explicit ClothModel(const World& world);

  // Anew, of these cloths' materials. explicit_step: where it is above 0, springs that an explicit
  // step of that length (s) takes stably are models of their own (element/explicit_split.h).
  void make_springs(const World& world, double explicit_step = 0.0);

  Index nodes() const { return static_cast<Index>(start_.x.size()); }
  std::span<const ClothPart> parts() const { return parts_; }
  const std::vector<std::unique_ptr<SpringModel>>& springs() const { return springs_; }
  std::vector<const ForceModel*> force_models() const;
  std::vector<const SpringModel*> stretch_springs() const;
  const ExternalForces& external() const { return *external_; }
  const State& start() const { return start_; }
  // All cloths' triangles with system node numbers, and texture coordinates (one per node).
  const TriangleMesh& surface() const { return surface_; }

  // Other start positions, one a node; what pins hold must be where it was. m.
  void place_start(std::span<const Vec3> x);

  // In the order of the world's, then those that the program added.
  std::vector<PinnedNodes>& pins() { return pins_; }
  std::span<const PinnedNodes> pins() const { return pins_; }
  // The pins' constraints for a step from x at `time` to time + h: displacements to where they will
  // be.
  void constrain_pins(double time, double h, std::span<const Vec3> x,
                      ConstraintSet& constraints) const;

 private:
  void add_cloth(const ClothOptions& cloth, std::vector<double>& masses);
  void add_pin(const WorldPin& pin);

  std::vector<ClothPart> parts_;
  std::vector<std::unique_ptr<SpringModel>> springs_;
  std::unique_ptr<ExternalForces> external_;
  std::vector<PinnedNodes> pins_;
  State start_;
  TriangleMesh surface_;
};

}  // namespace taut
