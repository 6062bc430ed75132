#pragma once
// Broad phase: which vertices, edges and triangles of a surface may come near each other in a step
// (docs/design/collision-detection.md).
//
//   moving box  of a vertex, an edge or a triangle: the smallest box around its corners at x0 and
//               that at x1 (m), and all that lie between the two; straight paths stay inside
//   margin      m: every pair that is ever within `margin` of each other in the step is reported.
//               The reverse does not hold: a pair is dropped where along some axis its boxes are
//               further apart, on the same side, at x0 and at x1
//
// Left out: pairs that share a vertex; pairs with both sides on solids; where `moved` is given,
// pairs without a vertex marked in it. Each remaining pair is reported once, in an order that
// depends on the surface and the positions, not on the number of threads. Boxes are floats, rounded
// outwards. refit is O(n) and moves no node.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "taut/contact/collision_surface.h"

namespace taut {

struct VertexTriangle {
  Index vertex = 0, triangle = 0;
  auto operator<=>(const VertexTriangle&) const = default;
};
struct EdgeEdge {
  Index first = 0, second = 0;  // first < second
  auto operator<=>(const EdgeEdge&) const = default;
};
struct EdgeTriangle {
  Index edge = 0, triangle = 0;
  auto operator<=>(const EdgeTriangle&) const = default;
};

class BroadPhase {
 public:
  // Keeps a reference to the surface, which must outlive it. `positions` (m, one a vertex) decide
  // how the trees are grouped: any will do, the shape at the start of a simulation does well.
  BroadPhase(const CollisionSurface& surface, std::span<const Vec3> positions);
  ~BroadPhase();
  BroadPhase(BroadPhase&&) noexcept;
  BroadPhase& operator=(BroadPhase&&) noexcept;

  // Sets all boxes for a step from x0 to x1 (m, one a vertex each; the same span twice for a shape
  // at rest). margin >= 0, m. A vertex that is not finite gets a box around everything.
  void refit(std::span<const Vec3> x0, std::span<const Vec3> x1, double margin);
  // The same, where since the last refit only vertices marked in `moved` have got another way, with
  // the same margin.
  void refit_moved(std::span<const Vec3> x0, std::span<const Vec3> x1, double margin,
                   std::span<const std::uint8_t> moved);

  // Lists of pairs come in parts, so that each can be worked on while it is fresh: use(part, pairs)
  // is called at most once for each of the parts 0 ... parts-1, from several threads at once; put
  // together in order, with nothing for the others, they are the list. moved: empty for all pairs,
  // or one byte a vertex, not 0 where it moved.
  template <class Pair>
  using UsePart = std::function<void(Index part, std::span<const Pair> pairs)>;
  Index vertex_parts() const;  // of lists of pairs with a vertex
  Index edge_parts() const;    // of the others
  void for_vertex_triangle(const UsePart<VertexTriangle>& use,
                           std::span<const std::uint8_t> moved = {}) const;
  void for_edge_edge(const UsePart<EdgeEdge>& use, std::span<const std::uint8_t> moved = {}) const;
  void for_edge_triangle(const UsePart<EdgeTriangle>& use,
                         std::span<const std::uint8_t> moved = {}) const;

  // The whole lists. Replace `pairs`.
  void find_vertex_triangle(std::vector<VertexTriangle>& pairs,
                            std::span<const std::uint8_t> moved = {}) const;
  void find_edge_edge(std::vector<EdgeEdge>& pairs, std::span<const std::uint8_t> moved = {}) const;
  void find_edge_triangle(std::vector<EdgeTriangle>& pairs,
                          std::span<const std::uint8_t> moved = {}) const;

  const CollisionSurface& surface() const { return *surface_; }

 private:
  struct Trees;
  const CollisionSurface* surface_;
  std::unique_ptr<Trees> trees_;
};

}  // namespace taut
