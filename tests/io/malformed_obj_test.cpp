// Odd and broken OBJ files that other projects collected: each is read rightly or refused with its
// place, in 2 s and 1 GB.
#include "io/malformed_table.h"
#include "taut/io/obj.h"

namespace taut::test {
namespace {

std::string obj_summary(const std::filesystem::path& path) {
  const TriangleMesh mesh = read_obj(path);
  return std::to_string(mesh.positions.size()) + " vertices " +
         std::to_string(mesh.triangles.size()) + " triangles" +
         (mesh.texcoords.empty() ? "" : " texcoords");
}

TEST(MalformedObj, EachFileIsReadRightlyOrRefusedWithItsPlace) {
  check_table(
      {
          {"assimp-box_UTF16BE.obj", ":1", "UTF-16"},
          {"assimp-box_without_lineending.obj", "", "8 vertices 12 triangles"},
          {"assimp-empty.obj", refused_without_line, "has no vertices"},
          // An `f` without corners.
          {"assimp-malformed2.obj", ":23:1", "a face with 0 corners, at least 3 were expected"},
          // Forms such as +2. and 2.e+1 in lines 1 to 9 are numbers, 3.1+e2 is none in any
          // notation.
          {"assimp-number_formats.obj", ":11:14",
           "z of the vertex is '3.1+e2', a number was expected"},
          {"assimp-regr_3429812.obj", "", "4 vertices 4 triangles"},
          {"tol-colorspace-issue-184.obj", "", "3 vertices 1 triangles"},
          {"tol-cube-vertexcol.obj", "", "8 vertices 12 triangles"},
          {"tol-invalid-face-definition.obj", ":15:1",
           "a face with 1 corner, at least 3 were expected"},
          {"tol-invalid-relative-vertex-index.obj", ":1:3",
           "vertex index is '-4', but the file has only 0 so far"},
          {"tol-issue-140-zero-face-idx.obj", ":16:3", "vertex index is 0; OBJ counts from 1"},
          {"tol-issue-162-smoothing-group.obj", "", "8 vertices 12 triangles texcoords"},
          {"tol-issue-244-mtl-searchpaths.obj", "", "8 vertices 2 triangles"},
          {"tol-issue-248-texres-texopt.obj", "", "8 vertices 12 triangles"},
          // Polygons of 7, 8 and 5 corners.
          {"tol-issue-319-002.obj", "", "20 vertices 14 triangles"},
          {"tol-issue-330.obj", "", "7 vertices 3 triangles"},
          {"tol-issue-92.obj", "", "3 vertices 1 triangles"},
          {"tol-issue-95.obj", "", "3 vertices 1 triangles"},
          {"tol-leading-zero-in-exponent-notation-issue-210.obj", "", "3 vertices 1 triangles"},
          {"tol-mtllib-multiple-files-issue-112.obj", "", "3 vertices 1 triangles"},
          {"tol-pbr-mat-ext.obj", "", "4 vertices 2 triangles"},
          {"tol-refl.obj", "", "8 vertices 12 triangles"},
          // Its faces name normals that stand in comments only; normals are not used.
          {"tol-smoothing-group-two-squares.obj", "", "6 vertices 3 triangles"},
          {"tol-test-nan.obj", ":12:3", "x of the vertex is 'nan', a finite number was expected"},
          {"tol-texture-options-issue-85.obj", "", "3 vertices 1 triangles"},
          {"trimesh-empty.obj", refused_without_line, "has no vertices"},
          // Corners with an empty last part: 2/2/.
          {"trimesh-jacked.obj", "", "8 vertices 12 triangles texcoords"},
          // Only colours are NaN.
          {"trimesh-nancolor.obj", "", "8 vertices 12 triangles"},
          {"trimesh-notenoughindices.obj", ":9:1",
           "a face with 2 corners, at least 3 were expected"},
          {"trimesh-polygonfaces.obj", "", "5 vertices 3 triangles"},
      },
      ".obj", obj_summary);
}

}  // namespace
}  // namespace taut::test
