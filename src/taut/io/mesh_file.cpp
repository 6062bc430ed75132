#include "taut/io/mesh_file.h"

#include <algorithm>

#include "taut/base/error.h"
#include "taut/io/obj.h"
#include "taut/io/ply.h"
#include "taut/io/usd.h"

namespace taut {

TriangleMesh read_mesh(const std::filesystem::path& path, const std::string& prim,
                       std::vector<std::string>* notes) {
  const std::filesystem::path name = path.extension() == ".gz" ? path.stem() : path.filename();
  std::string extension = name.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (path.extension() != ".gz" &&
      (extension == ".usd" || extension == ".usda" || extension == ".usdc" || extension == ".usdz"))
    return read_usd(path, prim, notes);
  if (!prim.empty())
    throw InputError({path.string()}, "is no USD file: leave out prim = \"" + prim + "\"");
  if (extension == ".obj") return read_obj(path, notes);
  if (extension == ".ply") return read_ply(path, notes);
  throw InputError({path.string()},
                   "is no mesh file that Taut reads; .obj or .ply was expected (also .gz after "
                   "it), or .usd, .usda, .usdc, .usdz");
}

}  // namespace taut
