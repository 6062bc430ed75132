// find_faults and check_cloth_mesh of mesh/topology.h.
#include <algorithm>
#include <cassert>

#include "taut/base/error.h"
#include "taut/mesh/topology.h"

namespace taut {

namespace {

// Twice the area over the squared longest edge is about the smallest angle in radians.
constexpr double smallest_angle = 1e-10;

bool has_no_area(const TriangleMesh& mesh, Index triangle) {
  const Triangle& t = mesh.triangles[triangle];
  double longest = 0;
  for (int c = 0; c < 3; ++c)
    longest =
        std::max(longest, (mesh.positions[t[c]] - mesh.positions[t[(c + 1) % 3]]).squaredNorm());
  return 2 * triangle_area(mesh, triangle) <= smallest_angle * longest;
}

std::string number(Index i) { return std::to_string(Offset{i} + 1); }

std::string triangle_text(const TriangleMesh& mesh, Index triangle) {
  const Triangle& t = mesh.triangles[triangle];
  return "triangle " + number(triangle) + " (vertices " + number(t[0]) + ", " + number(t[1]) +
         ", " + number(t[2]) + ")";
}

std::string others(std::size_t count) {
  return count > 1 ? " (" + std::to_string(count) + " in all)" : "";
}

}  // namespace

MeshFaults find_faults(const TriangleMesh& mesh) {
  MeshFaults faults;
  std::vector<char> used(mesh.positions.size(), 0);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    const auto triangle = static_cast<Index>(f);
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      faults.repeated_vertex.push_back(triangle);
      continue;
    }
    for (const Index vertex : t) used[vertex] = 1;
    if (has_no_area(mesh, triangle)) faults.zero_area.push_back(triangle);
  }
  for (std::size_t v = 0; v < used.size(); ++v)
    if (!used[v]) faults.isolated_vertices.push_back(static_cast<Index>(v));
  return faults;
}

void check_cloth_mesh(const TriangleMesh& mesh, const std::string& name) {
  const MeshFaults faults = find_faults(mesh);
  if (!faults.repeated_vertex.empty())
    throw InputError({name}, triangle_text(mesh, faults.repeated_vertex[0]) +
                                 " names a vertex twice" + others(faults.repeated_vertex.size()) +
                                 "; remove degenerate faces before export");
  if (!faults.zero_area.empty())
    throw InputError({name},
                     triangle_text(mesh, faults.zero_area[0]) + " has no area" +
                         others(faults.zero_area.size()) +
                         "; merge doubled vertices or remove degenerate faces before export");
  if (!faults.isolated_vertices.empty())
    throw InputError({name}, "vertex " + number(faults.isolated_vertices[0]) +
                                 " is in no triangle" + others(faults.isolated_vertices.size()) +
                                 " and would have no mass; remove loose vertices before export");
}

}  // namespace taut
