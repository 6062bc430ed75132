#pragma once
// The scene's cloths as one system of nodes: positions, masses, springs, pins. Nodes of cloth c are
// first_node ... first_node + node_count - 1, in the order of its grid or file.

#include <memory>

#include "taut/constraint/constraint_set.h"
#include "taut/element/external.h"
#include "taut/element/spring_model.h"
#include "taut/scene/scene.h"
#include "taut/step/state.h"

namespace taut {

struct ClothPart {
  std::string name;
  Index first_node = 0, node_count = 0;
  Index first_triangle = 0, triangle_count = 0;
  std::uint64_t file_sum = 0;  // of what its mesh file holds (base/checksum.h); 0: it has none
};

// Ascending, each once.
std::vector<Index> selected_nodes(const Cloth& cloth, const NodeSelection& where);

// A pin's nodes and their places at time 0.
struct PinnedNodes {
  std::vector<Index> nodes;
  std::vector<Vec3> start;  // m
  Solid path;               // carries the key frames; its pose is the pin's
  Vec3 pivot = Vec3::Zero();
  double release = -1.0;  // s
  // Where a node should be at this time, m.
  Vec3 target(std::size_t k, double time) const;
  bool holds(double time) const { return release < 0.0 || time < release; }
};

class ClothModel {
 public:
  // Builds everything the scene says; reads mesh files. Throws InputError (unreadable mesh, faulty
  // triangles, pins of nodes that do not exist).
  explicit ClothModel(const Scene& scene);

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

  // The pins' constraints for a step from x at `time` to time + h: displacements to where the path
  // will be.
  void constrain_pins(double time, double h, std::span<const Vec3> x,
                      ConstraintSet& constraints) const;

 private:
  void add_cloth(const Cloth& cloth, const Scene& scene, std::vector<double>& masses);
  void add_pins(const Cloth& cloth, const ClothPart& part);

  std::vector<ClothPart> parts_;
  std::vector<std::unique_ptr<SpringModel>> springs_;
  std::unique_ptr<ExternalForces> external_;
  std::vector<PinnedNodes> pins_;
  State start_;
  TriangleMesh surface_;
};

}  // namespace taut
