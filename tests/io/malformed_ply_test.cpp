// Odd and broken PLY files that other projects collected: each is read rightly or refused with its
// place, in 2 s and 1 GB.
#include <Eigen/Core>

#include "io/malformed_table.h"
#include "taut/io/ply.h"

namespace taut::test {
namespace {

std::string ply_summary(const std::filesystem::path& path) {
  const TriangleMesh mesh = read_ply(path);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : mesh.positions) sum += x;
  return std::to_string(mesh.positions.size()) + " vertices " +
         std::to_string(mesh.triangles.size()) + " triangles" +
         (mesh.texcoords.empty() ? "" : " texcoords") + " sum " +
         std::to_string(std::lround(sum.sum()));
}

TEST(MalformedPly, EachFileIsReadRightlyOrRefusedWithItsPlace) {
  check_table(
      {
          {"assimp-crash-30d6d0f7c529b3b66b4131700b7a4580cd7082df.ply", ":7:10",
           "the type is '\\x00\\x00\\x00"},
          // The first byte of the data is that of a line end. A cube of edge 1 from x = 5.967 on: 8
          // x 5.967 + 12 = 59.7.
          {"assimp-cube_binary_starts_with_nl.ply", "", "8 vertices 12 triangles sum 60"},
          {"assimp-float-color.ply", "", "3 vertices 1 triangles sum 500"},
          // It says `format ascii` without a version; later come two elements `vertex`.
          {"assimp-payload_JVN42386607", ":2:13", "the format's version is ''; 1.0 was expected"},
          {"trimesh-plane.ply", "", "4 vertices 2 triangles texcoords sum 0"},
          {"trimesh-ply_empty_header.ply", refused_without_line, "has no vertices"},
          {"trimesh-points_ascii_with_lists.ply", refused_without_line,
           "has 5 vertices but no faces"},
      },
      ".ply", ply_summary);
}

}  // namespace
}  // namespace taut::test
