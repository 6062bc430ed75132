#include "taut/picture/surface.h"

#include <fmt/format.h>

#include "taut/base/error.h"

namespace taut {

namespace {

[[noreturn]] void refuse(const Surface& surface, const std::string& message) {
  throw InputError(fmt::format("surface '{}': {}", surface.name, message));
}

void check_positions(const Surface& s) {
  constexpr double too_far = 1e15;  // m; beyond it single precision rays overflow
  for (std::size_t i = 0; i < s.positions.size(); ++i) {
    const Vec3& p = s.positions[i];
    if (!(p.cwiseAbs().maxCoeff() < too_far) || !p.allFinite())
      refuse(s,
             fmt::format("vertex {} is at ({}, {}, {}), expected finite coordinates below {:g} m",
                         i, p.x(), p.y(), p.z(), too_far));
  }
}

void check_triangles(const Surface& s) {
  const auto count = static_cast<Index>(s.positions.size());
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    for (const Index v : s.triangles[t])
      if (v < 0 || v >= count)
        refuse(s, fmt::format("triangle {} names vertex {}, expected 0 to {}", t, v, count - 1));
}

void check_lengths(const Surface& s) {
  const std::size_t count = s.positions.size();
  if (!s.texcoords.empty() && s.texcoords.size() != count)
    refuse(s, fmt::format("{} texture coordinates for {} vertices, expected none or one each",
                          s.texcoords.size(), count));
  if (!s.normals.empty() && s.normals.size() != count)
    refuse(s, fmt::format("{} normals for {} vertices, expected none or one each", s.normals.size(),
                          count));
  if (s.pattern != Pattern::none && s.texcoords.empty() && count > 0)
    refuse(s, "a pattern needs texture coordinates and there are none; use Pattern::none");
  for (std::size_t i = 0; i < s.texcoords.size(); ++i)
    if (!s.texcoords[i].allFinite())
      refuse(s, fmt::format("texture coordinate {} is not finite", i));
  for (std::size_t i = 0; i < s.normals.size(); ++i)
    if (!s.normals[i].allFinite()) refuse(s, fmt::format("normal {} is not finite", i));
}

void check_look(const Surface& s) {
  const auto share = [](double x) { return x >= 0.0 && x <= 1.0; };
  for (const Colour* c : {&s.front, &s.back})
    if (!share(c->x()) || !share(c->y()) || !share(c->z()))
      refuse(s, fmt::format("colour ({}, {}, {}), expected components from 0 to 1", c->x(), c->y(),
                            c->z()));
  if (!share(s.translucency))
    refuse(s, fmt::format("translucency {}, expected 0 to 1", s.translucency));
  if (!share(s.gloss)) refuse(s, fmt::format("gloss {}, expected 0 to 1", s.gloss));
  if (!s.pattern_cells.allFinite()) refuse(s, "pattern_cells is not finite");
}

}  // namespace

void check_surface(const Surface& surface) {
  check_positions(surface);
  check_triangles(surface);
  check_lengths(surface);
  check_look(surface);
}

}  // namespace taut
