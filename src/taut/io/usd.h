#pragma once
// Meshes in USD files (.usd, .usda, .usdc, .usdz), read by OpenUSD's own Python module `pxr`, in a
// process of its own (why: docs/design/readers.md).
//
//   positions   m, z up: local-to-world transform x points, times the stage's metersPerUnit (0.01
//               where it has none), turned if upAxis is Y: (x, y, z) becomes (x, -z, y)
//   triangles   polygons cut into fans; turned around where the mesh is left-handed or its
//               transform mirrors
//   texcoords   primvars:st, UVMap or the first other one of pairs; of one a corner, the first that
//               a vertex gets
//   prim        the mesh's path, or that of a prim with a single mesh below it; empty where the
//               file has only one
//
// Of what moves, the earliest time. python3 from PATH, or $TAUT_PYTHON, with the package usd-core.
// Throws InputError naming the file, also where Python or pxr is missing, and how to get them.

#include <filesystem>
#include <string>
#include <vector>

#include "taut/mesh/triangle_mesh.h"

namespace taut {

TriangleMesh read_usd(const std::filesystem::path& path, const std::string& prim = {},
                      std::vector<std::string>* notes = nullptr);

}  // namespace taut
