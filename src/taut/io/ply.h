#pragma once
// PLY meshes ("Stanford" polygon files), text and binary (G. Turk, "The PLY
// Polygon File Format", 1994).
//
//   vertex   x, y, z of any numeric type; texture coordinates s, t or u, v or texture_u, texture_v
//   face     a list vertex_indices or vertex_index; polygons are cut into fans (io/polygon_fan.h)
//
// Other elements and properties are passed over. LF, CRLF or CR; gzip. Vertices keep the file's
// order. Written: binary little-endian, float32 x, y, z, s and t when there are texture
// coordinates, faces as uchar, int. Throws InputError, in text with line and column, in binary
// files with the number of vertex or face (from 0) and the byte. Time and memory are linear in the
// size of the file, whatever its header claims. What is refused: docs/design/readers.md.

#include <filesystem>
#include <string>
#include <vector>

#include "taut/mesh/triangle_mesh.h"

namespace taut {

// `notes` (when given) receives what was read but may not be what the user meant, one located
// sentence each.
TriangleMesh read_ply(const std::filesystem::path& path, std::vector<std::string>* notes = nullptr);

// Through a temporary file; throws InputError when that cannot be written.
void write_ply(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace taut
