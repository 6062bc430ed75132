#include <ostream>
#include <string>

#include "taut/base/file.h"
#include "taut/io/obj.h"
#include "taut/io/shortest_decimal.h"

namespace taut {

namespace {

template <class Vector>
std::string statement(const char* keyword, const Vector& v, ObjDigits digits) {
  std::string line = keyword;
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    line += ' ';
    if (digits == ObjDigits::of_float)
      append_decimal(line, static_cast<float>(v[i]));
    else
      append_decimal(line, v[i]);
  }
  return line += '\n';
}

std::string corner(Index vertex, bool with_texcoord) {
  const std::string number = std::to_string(Offset{vertex} + 1);
  return with_texcoord ? ' ' + number + '/' + number : ' ' + number;
}

}  // namespace

void write_obj(const std::filesystem::path& path, const TriangleMesh& mesh, ObjDigits digits) {
  const bool with_texcoords = !mesh.texcoords.empty();
  write_file(path, [&](std::ostream& out) {
    for (const Vec3& position : mesh.positions) out << statement("v", position, digits);
    for (const Vec2& texcoord : mesh.texcoords) out << statement("vt", texcoord, digits);
    for (const Triangle& t : mesh.triangles)
      out << 'f' << corner(t[0], with_texcoords) << corner(t[1], with_texcoords)
          << corner(t[2], with_texcoords) << '\n';
  });
}

}  // namespace taut
