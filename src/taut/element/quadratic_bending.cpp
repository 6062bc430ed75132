#include "taut/element/quadratic_bending.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/mesh/topology.h"

namespace taut {

namespace {

constexpr Index hinges_per_task = 512;

// Calls f(block of the element, first corner, second corner) for the upper triangle.
template <class Function>
void for_each_block(Function f) {
  Index block = 0;
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a; b < 4; ++b) f(block++, a, b);
}

// w of a node field.
Vec3 bent(const BendingHinge& h, std::span<const Vec3> field) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t a = 0; a < 4; ++a) sum += h.weight[a] * field[h.node[a]];
  return sum;
}

// Of the angle at `at` between the directions to the other two.
double cotangent(const Vec3& at, const Vec3& one, const Vec3& other) {
  return (one - at).dot(other - at) / (one - at).cross(other - at).norm();
}

}  // namespace

std::vector<BendingHinge> bending_hinges(const TriangleMesh& rest, double rigidity, double damping,
                                         Index first_node, const std::string& cloth_name) {
  std::vector<BendingHinge> hinges;
  for (const Hinge& of : build_topology(rest).hinges) {
    BendingHinge h;
    const auto at = [&](std::size_t a) -> const Vec3& {
      return rest.positions[h.node[a] - first_node];
    };
    h.node = {of.edge.a, of.edge.b, of.opposite[0], of.opposite[1]};
    for (Index& node : h.node) node += first_node;
    double area = 0.0;
    for (const std::size_t side : {0u, 1u}) {
      const double own = triangle_area(rest, of.triangle[side]);
      if (!(own > 0.0))
        throw InputError(fmt::format(
            "cloth '{}': triangle {} has no area, so that its bending stiffness would be infinite; "
            "remove it or move its corners apart",
            cloth_name, of.triangle[side] + 1));
      const double at_0 = cotangent(at(0), at(1), at(2 + side)),
                   at_1 = cotangent(at(1), at(0), at(2 + side));
      h.weight[0] += at_1, h.weight[1] += at_0, h.weight[2 + side] = -(at_0 + at_1);
      area += own;
    }
    h.stiffness = 3.0 * rigidity / area;
    h.damping = 3.0 * damping / area;
    hinges.push_back(h);
  }
  return hinges;
}

void QuadraticBending::connect(ConnectionSink& sink) const {
  for (Index e = 0; e < static_cast<Index>(hinges_.size()); ++e) {
    const auto& node = hinges_[e].node;
    for_each_block([&](Index block, std::size_t a, std::size_t b) {
      sink.matrix(10 * e + block, node[a], node[b], +1, false);
      if (a != b) sink.matrix(10 * e + block, node[b], node[a], +1, true);
    });
    for (Index a = 0; a < 4; ++a) sink.vector(4 * e + a, node[static_cast<std::size_t>(a)], +1);
  }
}

void QuadraticBending::evaluate(const ForceRequest& request, std::span<double> blocks,
                                std::span<Vec3> vectors) const {
  parallel_for(static_cast<Index>(hinges_.size()), hinges_per_task, [&](Index begin, Index end) {
    for (Index e = begin; e < end; ++e) {
      const BendingHinge& h = hinges_[e];
      Vec3 g = -request.force * h.stiffness * bent(h, request.x);
      if (h.damping != 0.0) g -= request.force * h.damping * bent(h, request.v);
      if (!request.stiffness_operand.empty()) g += h.stiffness * bent(h, request.stiffness_operand);
      if (!request.damping_operand.empty()) g += h.damping * bent(h, request.damping_operand);
      for (std::size_t a = 0; a < 4; ++a)
        vectors[4 * static_cast<std::size_t>(e) + a] = h.weight[a] * g;
      if (!request.wants_matrix()) continue;
      const double k = request.matrix_stiffness * h.stiffness + request.matrix_damping * h.damping;
      for_each_block([&](Index block, std::size_t a, std::size_t b) {
        double* out = &blocks[9 * static_cast<std::size_t>(10 * e + block)];
        std::fill(out, out + 9, 0.0);
        out[0] = out[4] = out[8] = k * h.weight[a] * h.weight[b];
      });
    }
  });
}

void QuadraticBending::bound_blocks(double matrix_stiffness, double matrix_damping,
                                    std::span<double> bounds) const {
  for (Index e = 0; e < static_cast<Index>(hinges_.size()); ++e) {
    const BendingHinge& h = hinges_[e];
    const double k = matrix_stiffness * h.stiffness + matrix_damping * h.damping;
    for_each_block([&](Index block, std::size_t a, std::size_t b) {
      bounds[10 * e + block] = k * std::abs(h.weight[a] * h.weight[b]);
    });
  }
}

double QuadraticBending::energy(std::span<const Vec3> x) const {
  return ordered_sum(static_cast<Index>(hinges_.size()), [&](Index begin, Index end) {
    double sum = 0.0;
    for (Index e = begin; e < end; ++e)
      sum += 0.5 * hinges_[e].stiffness * bent(hinges_[e], x).squaredNorm();
    return sum;
  });
}

}  // namespace taut
