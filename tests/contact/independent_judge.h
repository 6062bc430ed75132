#pragma once
// Whether a surface intersects itself, judged by CGAL's exact predicates: nothing from
// src/taut/contact has a say. Built where CGAL is installed (tests/contact/judge); a test asks
// judge_available() and skips where it is not.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "taut/mesh/triangle_mesh.h"

namespace taut::test {

bool judge_available();
inline const char* no_judge = "CGAL was not found when the tests were built: install libcgal-dev";

// All pairs of triangles (i < j, sorted) that share no vertex and have a point in common; touching
// counts. Pairs with both triangles on vertices marked in is_solid (empty, or one byte a vertex)
// are left out. Triangles without area are not allowed.
std::vector<std::array<Index, 2>> intersecting_triangles(
    std::span<const Vec3> x, std::span<const Triangle> triangles,
    std::span<const std::uint8_t> is_solid = {});

// Does the closed segment a b (a != b) meet the closed triangle c d e (of some area)?
bool judge_segment_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                            const Vec3& e);

}  // namespace taut::test
