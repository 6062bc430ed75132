#include <ostream>
#include <string>

#include "taut/base/file.h"
#include "taut/io/little_endian.h"
#include "taut/io/ply.h"

namespace taut {

namespace {

std::string header(const TriangleMesh& mesh) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                     std::to_string(mesh.positions.size()) + '\n';
  for (const char* axis : {"x", "y", "z"}) text += std::string("property float ") + axis + '\n';
  if (!mesh.texcoords.empty()) text += "property float s\nproperty float t\n";
  return text + "element face " + std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

}  // namespace

void write_ply(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::string bytes = header(mesh);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (const double x : mesh.positions[i]) append_little_endian(bytes, static_cast<float>(x));
    if (mesh.texcoords.empty()) continue;
    for (const double u : mesh.texcoords[i]) append_little_endian(bytes, static_cast<float>(u));
  }
  for (const Triangle& t : mesh.triangles) {
    bytes += '\3';
    for (const Index vertex : t) append_little_endian(bytes, vertex);
  }
  write_file(path, bytes);
}

}  // namespace taut
