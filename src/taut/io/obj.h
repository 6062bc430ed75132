#pragma once
// Wavefront OBJ meshes.
//
// Read: `v` (first three numbers; a weight or a colour after them is not used), `vt` (first two),
// `f` in all forms (v, v/vt, v//vn, v/vt/vn, also with an empty last part; counted from 1, or
// backwards from -1), polygons (cut into a fan of triangles, see io/polygon_fan.h), comments,
// continued lines, LF, CRLF or CR, gzip. Other statements do not describe the shape and are passed
// over; those that OBJ does not know are named in `notes`. Vertices keep the file's order, also
// those that no face uses. OBJ has one texture coordinate per corner, TriangleMesh one per vertex:
// the first that a vertex gets in the file counts (notes say how many have several); texcoords
// stays empty when a used vertex has none.
//
// Source: Wavefront, Advanced Visualizer manual, appendix B1 (object files), as far as triangle
// meshes need it. Why an own parser: tinyobjloader names neither line nor column and passes over
// faces and numbers that it does not understand.
//
// Throws InputError with file, line and column for: a number that is none, NaN, infinite or too
// large; a face with fewer than three corners; an index that is 0 or beyond the vertices of the
// whole file; no vertex or no face at all; text that is not UTF-8 or ASCII. Time and memory are
// linear in the size of the file. Safe to call from several threads.

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

// `v` with the shortest decimals that read back to the same doubles, or floats, `vt` likewise when
// there are any, `f` counted from 1. Through a temporary file; throws InputError when that cannot
// be written.
enum class ObjDigits { of_double, of_float };
void write_obj(const std::filesystem::path& path, const TriangleMesh& mesh,
               ObjDigits digits = ObjDigits::of_double);

}  // namespace taut
