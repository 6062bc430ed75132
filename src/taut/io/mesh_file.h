#pragma once
// A mesh from a file, by its extension: .obj (io/obj.h) or .ply (io/ply.h), also gzip'd with .gz after it.

#include <filesystem>
#include <string>
#include <vector>

#include "taut/mesh/triangle_mesh.h"

namespace taut {

// Throws InputError for another extension, and as read_obj and read_ply.
TriangleMesh read_mesh(const std::filesystem::path& path, std::vector<std::string>* notes = nullptr);

}  // namespace taut
