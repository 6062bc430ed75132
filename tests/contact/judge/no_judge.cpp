// In place of independent_judge.cpp where CGAL is not installed.
#include <stdexcept>

#include "contact/independent_judge.h"

namespace taut::test {

bool judge_available() { return false; }

std::vector<std::array<Index, 2>> intersecting_triangles(std::span<const Vec3>,
                                                         std::span<const Triangle>,
                                                         std::span<const std::uint8_t>) {
  throw std::logic_error(no_judge);
}

bool judge_segment_triangle(const Vec3&, const Vec3&, const Vec3&, const Vec3&, const Vec3&) {
  throw std::logic_error(no_judge);
}

}  // namespace taut::test
