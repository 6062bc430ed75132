#pragma once
// Which nodes of a cloth are joined by springs.
//
//   grid    up to 12 neighbours a node: 4 stretch (grid edges), 4 shear (cell diagonals), 4 bend
//           (two nodes apart along a line); Provot 1995
//   mesh    stretch on each edge, bend across each interior edge (between the two opposite
//           vertices), no separate shear
//
// Rest lengths (m) are the distances in `rest`. Node numbers are shifted by `first_node`, so that
// several cloths share one system. A spring of rest length 0 is refused (InputError naming the
// nodes): two nodes lie in one place.

#include <memory>
#include <string>

#include "taut/element/spring_material.h"
#include "taut/element/spring_model.h"
#include "taut/mesh/grid.h"

namespace taut {

// One model per class that has springs, in the order stretch, shear, bend.
std::vector<std::unique_ptr<SpringModel>> grid_springs(const GridShape& shape,
                                                       std::span<const Vec3> rest,
                                                       const SpringMaterial& material,
                                                       Index first_node,
                                                       const std::string& cloth_name);
std::vector<std::unique_ptr<SpringModel>> mesh_springs(const TriangleMesh& mesh,
                                                       const SpringMaterial& material,
                                                       Index first_node,
                                                       const std::string& cloth_name);

}  // namespace taut
