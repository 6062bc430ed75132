#pragma once
// Continuous collision detection: does a vertex meet a triangle, or an edge an edge, while all of
// them move along straight lines?
//
//   x(t) = (1 - t) x0 + t x1        each vertex, t in [0, 1], no unit
//   hit     the distance is at most `minimum_separation` at some t in [0, 1]. Touching counts, and
//           so does contact at t = 0
//   time    a lower bound of the first such t. At `time` and at all times before, the pair is
//           surely further apart than `minimum_separation`; the only exception is time = 0, where
//           nothing was proved
//
// CONSERVATIVE: "no hit" is proved, rounding included. What is reported as a hit may be a near
// miss: the pair comes as near as minimum_separation + tolerance (or as rounding, see below), or
// max_checks ran out. Non-finite coordinates are a hit at time 0.
//
// Why it cannot miss. Write the pair's differences of corners as D_k(t): p - a, p - b, p - c, or
// a - c, a - d, b - c, b - d. Each is linear in t, and the difference between any two points of the
// two shapes is a weighted mean of them. So if for some unit vector n
//
//   n·D_k(t) > minimum_separation     for all k, at t = r and at t = s,
//
// it holds at all t between and for all pairs of points: the plane with normal n separates the pair
// throughout [r, s]. The algorithm walks from r = 0: n is the direction between the closest points
// at r, s the last time up to which that plane separates; then r = s, until s = 1 (no hit) or the
// distance is used up (hit at r). How n and s are found does not matter for the proof: the
// inequality at both ends is then tested, with
//
//   n·D_k(t) evaluated > minimum_separation |n| + 16 u sum_i |n_i| max_k |D_k,i|     u = 2^-53
//
// which bounds all rounding: differences of given doubles have a relative error of u, the products
// and sums of n·D and of the mean over t add less than 8 u (docs/mathematics.md, section 6). The
// error is relative to the pair's size, not to its distance from the origin. The purpose is the
// same as of Wang, Ferguson, Schneider, Jiang, Attene and Panozzo, "A Large Scale Benchmark and an
// Inclusion-Based Algorithm for Continuous Collision Detection" (ACM Transactions on Graphics
// 2021): bounds in place of roots. There (t, u, v) is halved; here only t is advanced, since a
// plane settles all (u, v) at once.
//
// Callable from any thread; no allocation.

#include <array>
#include <span>
#include <vector>

#include "taut/contact/broad_phase.h"

namespace taut {

struct CcdOptions {
  double minimum_separation = 0.0;  // m
  // m: nearer than minimum_separation + tolerance may be called a hit
  double tolerance = 1e-10;
  // planes tried for a pair, at most; a pair that needs more is a hit at the time reached
  int max_checks = 1000;
  bool operator==(const CcdOptions&) const = default;
};

struct Impact {
  bool hit = false;
  double time = 1.0;  // no unit; 1 where nothing was hit
  bool operator==(const Impact&) const = default;
};

Impact vertex_triangle_impact(const Vec3& p0, const Vec3& a0, const Vec3& b0, const Vec3& c0,
                              const Vec3& p1, const Vec3& a1, const Vec3& b1, const Vec3& c1,
                              const CcdOptions& options);
Impact edge_edge_impact(const Vec3& a0, const Vec3& b0, const Vec3& c0, const Vec3& d0,
                        const Vec3& a1, const Vec3& b1, const Vec3& c1, const Vec3& d1,
                        const CcdOptions& options);

// A pair of the list and its time of impact.
struct PairImpact {
  Index pair = 0;  // its place in the list
  double time = 0.0;
  bool operator==(const PairImpact&) const = default;
};

// All hits among the pairs, in the order of the list, the same for any number of threads. x0, x1:
// m, one a vertex. Replaces `hits`.
void find_impacts(const CollisionSurface& surface, std::span<const Vec3> x0,
                  std::span<const Vec3> x1, std::span<const VertexTriangle> pairs,
                  const CcdOptions& options, std::vector<PairImpact>& hits);
void find_impacts(const CollisionSurface& surface, std::span<const Vec3> x0,
                  std::span<const Vec3> x1, std::span<const EdgeEdge> pairs,
                  const CcdOptions& options, std::vector<PairImpact>& hits);
// The same of pairs given by their corners, in the order of the functions above: all of edges, or
// all of a vertex and a triangle.
void find_impacts(std::span<const std::array<Index, 4>> pairs, bool edges, std::span<const Vec3> x0,
                  std::span<const Vec3> x1, const CcdOptions& options,
                  std::vector<PairImpact>& hits);

}  // namespace taut
