#pragma once
// One thing to be drawn: a triangle mesh with two colours. Views only; the arrays must live as long
// as the call that draws them.
//
//   positions   m, one per vertex, Z up
//   triangles   three vertex indices each, from 0; the front is where they run counter-clockwise
//   texcoords   empty, or one (u, v) per vertex, no unit; needed for a pattern
//   normals     empty, or one outward unit vector per vertex
//   colours     sRGB, each component in [0, 1], as on a screen

#include <span>
#include <string>

#include "taut/base/types.h"
#include "taut/mesh/triangle_mesh.h"

namespace taut {

using Colour = Vec3;

// What is drawn over the colours from (u, v), so that stretch and slip can be seen.
enum class Pattern {
  none,
  checker,  // every other cell darker
  grid,     // a thin darker line between cells
};

struct Surface {
  std::string name = "surface";  // for messages
  std::span<const Vec3> positions;
  std::span<const Triangle> triangles;
  std::span<const Vec2> texcoords;
  std::span<const Vec3> normals;
  Colour front = Colour(0.22, 0.47, 0.74);
  Colour back = Colour(0.93, 0.64, 0.27);
  Pattern pattern = Pattern::none;
  Vec2 pattern_cells = Vec2(10, 10);  // cells per unit of u and v
  // without `normals`: area-weighted vertex normals; false draws facets
  bool smooth_normals = true;
  // share of the light that falls through to the other side, in [0, 1]; 0 for solids
  double translucency = 0.15;
  double gloss = 0.0;  // strength of a soft highlight, in [0, 1]
};

// A surface for a mesh in the default cloth colours.
inline Surface surface_of(const TriangleMesh& mesh) {
  Surface surface;
  surface.positions = mesh.positions;
  surface.triangles = mesh.triangles;
  surface.texcoords = mesh.texcoords;
  return surface;
}

// Throws InputError naming the surface and the vertex or triangle: a position or (u, v) that is not
// finite, an index out of range, arrays of different lengths, a pattern without (u, v), a colour,
// translucency or gloss out of range. An empty surface is fine and draws nothing.
void check_surface(const Surface& surface);

}  // namespace taut
