#pragma once
// A mesh from a file, by its extension: .obj (io/obj.h) or .ply (io/ply.h), also compressed, with
// .gz after it; .usd, .usda, .usdc or .usdz (io/usd.h).

#include <filesystem>
#include <string>
#include <vector>

#include "taut/mesh/triangle_mesh.h"

namespace taut {

// `prim`: which mesh of a USD file, empty for others. Throws InputError for another extension, and
// as read_obj, read_ply and read_usd.
TriangleMesh read_mesh(const std::filesystem::path& path, const std::string& prim = {},
                       std::vector<std::string>* notes = nullptr);

}  // namespace taut
