#pragma once
// Wavefront OBJ meshes (Wavefront, Advanced Visualizer manual, appendix B1).
//
//   v    the first three numbers
//   vt   the first two
//   f    in all forms, counted from 1 or backwards from -1; polygons are cut into a fan of
//        triangles (io/polygon_fan.h)
//
// Vertices keep the file's order, also those that no face uses. OBJ has one texture coordinate per
// corner, TriangleMesh one per vertex: the first that a vertex gets in the file counts. Throws
// InputError with file, line and column. Time and memory are linear in the size of the file. Safe
// to call from several threads. What else is read, and what is refused: docs/design/readers.md.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "taut/mesh/triangle_mesh.h"

namespace taut {

// `notes` (when given) receives what was read but may not be what the user meant, one located
// sentence each.
TriangleMesh read_obj(const std::filesystem::path& path, std::vector<std::string>* notes = nullptr);

// The same of text that is in memory; `file` stands in messages.
TriangleMesh parse_obj(const std::string& file, std::string_view text,
                       std::vector<std::string>* notes = nullptr);

// `v` with the shortest decimals that read back to the same doubles, or floats, `vt`
// likewise when there are any, `f` counted from 1. Through a temporary file; throws
// InputError when that cannot be written.
enum class ObjDigits { of_double, of_float };
void write_obj(const std::filesystem::path& path, const TriangleMesh& mesh,
               ObjDigits digits = ObjDigits::of_double);

}  // namespace taut
