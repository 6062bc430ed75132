#pragma once
// Who neighbours whom on a triangle mesh: the edges that carry stretch springs, the hinges that
// carry bend springs.
//
//   edge               two vertices a < b of some triangle; each once, sorted by (a, b)
//   hinge              an edge with two of its triangles, and their third vertices, `opposite`: the
//                      ends of a bend spring across the edge
//   boundary edge      in one triangle
//   non-manifold edge  in k > 2 triangles, as where a pocket is sewn onto a sheet: it gets the
//                      k - 1 hinges of triangles that follow each other in the mesh's order, so
//                      that no layer is left without bending
//
// Left out: hinges whose opposite vertices are the same, a doubled triangle (`folded_hinges` counts
// them), and triangles that name a vertex twice. Triangles of no area with three vertices count.
// Vertex indices must be in range (asserted; mesh readers guarantee it). Edges and hinges do not
// depend on the thread count. O(T log T) time and about 100 bytes a triangle.

#include <array>
#include <string>
#include <vector>

#include "taut/mesh/triangle_mesh.h"

namespace taut {

struct Edge {
  Index a = 0, b = 0;
  bool operator==(const Edge&) const = default;
  auto operator<=>(const Edge&) const = default;
};

//        opposite[0]
//          /    \          .
//     edge.a --- edge.b
//          \    /
//        opposite[1]
struct Hinge {
  Edge edge;
  std::array<Index, 2> opposite{};
  std::array<Index, 2> triangle{};  // opposite[s] is the third vertex of triangle[s]
};

struct Topology {
  std::vector<Edge> edges;
  std::vector<Hinge> hinges;  // sorted by edge
  std::vector<Edge> boundary_edges;
  std::vector<Edge> non_manifold_edges;  // not refused: real garments have them
  Index folded_hinges = 0;
};

Topology build_topology(const TriangleMesh& mesh);

// Area of a triangle, m^2.
double triangle_area(const TriangleMesh& mesh, Index triangle);
// Each vertex's share of the surface: a third of each of its triangles, m^2.
// The sum is the mesh's area.
std::vector<double> vertex_areas(const TriangleMesh& mesh);

// What a mesh must not have if it is to be cloth. Empty lists: nothing found.
struct MeshFaults {
  std::vector<Index> repeated_vertex;  // triangles that name a vertex twice
  // other triangles: twice the area <= 1e-10 x (longest edge)^2, so one angle is 0 to rounding
  std::vector<Index> zero_area;
  std::vector<Index> isolated_vertices;  // in no triangle: such a node would have no mass
  bool any() const {
    return !repeated_vertex.empty() || !zero_area.empty() || !isolated_vertices.empty();
  }
};
MeshFaults find_faults(const TriangleMesh& mesh);

// Throws InputError("NAME: ...") that names the first faulty triangle or vertex (counted from 1, as
// OBJ does), how many there are, and the remedy.
void check_cloth_mesh(const TriangleMesh& mesh, const std::string& name);

}  // namespace taut
