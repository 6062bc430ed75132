#include "contact/independent_judge.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>

namespace taut::test {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, Index>;

Point point(const Vec3& x) { return Point(x[0], x[1], x[2]); }

Kernel::Triangle_3 triangle(std::span<const Vec3> x, const Triangle& t) {
  return {point(x[t[0]]), point(x[t[1]]), point(x[t[2]])};
}

bool share_vertex(const Triangle& s, const Triangle& t) {
  return std::ranges::any_of(s, [&](Index v) { return std::ranges::find(t, v) != t.end(); });
}

}  // namespace

bool judge_available() { return true; }

std::vector<std::array<Index, 2>> intersecting_triangles(std::span<const Vec3> x,
                                                         std::span<const Triangle> triangles,
                                                         std::span<const std::uint8_t> is_solid) {
  std::vector<Box> boxes;
  for (Index t = 0; t < static_cast<Index>(triangles.size()); ++t)
    boxes.emplace_back(triangle(x, triangles[t]).bbox(), t);
  std::vector<std::array<Index, 2>> pairs;
  const auto test = [&](const Box& a, const Box& b) {
    const Triangle &s = triangles[a.info()], &t = triangles[b.info()];
    if (share_vertex(s, t)) return;
    if (!is_solid.empty() && is_solid[s[0]] && is_solid[t[0]]) return;
    if (CGAL::do_intersect(triangle(x, s), triangle(x, t)))
      pairs.push_back({std::min(a.info(), b.info()), std::max(a.info(), b.info())});
  };
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), test);
  std::ranges::sort(pairs);
  return pairs;
}

bool judge_segment_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                            const Vec3& e) {
  return CGAL::do_intersect(Kernel::Segment_3(point(a), point(b)),
                            Kernel::Triangle_3(point(c), point(d), point(e)));
}

}  // namespace taut::test
