#pragma once
// One condition on the end of a step: two points of the surface, or a node and a solid, keep their
// distance (docs/mathematics.md, 7.1).
//
//   r(x) = sum_k weight_k x_k   m, from the second point to the first. Weights: vertex against
//                               triangle (1, -a, -b, -c), edge against edge (1-s, s, -(1-t), -t),
//                               node against a plane (1)
//   n·r(x1) >= target           m; for a plane n·x1 >= target, n and target the plane's
//   lambda                      kg m: h times the impulse along n, accumulated, never negative
//   friction                    kg m: h times the tangential impulse, at most mu lambda (Coulomb)
//
// inverse mass of a node: 1/kg; 0 where it is held. Contact with analytic solids is a row of its
// own, not a direction without mass: a push that is nearly along such a direction would throw the
// node sideways.

#include <array>
#include <span>
#include <vector>

#include "taut/base/types.h"
#include "taut/contact/row_slabs.h"

namespace taut {

struct ContactRow {
  // What every visit reads comes first.
  std::array<Index, 4> node{-1, -1, -1, -1};  // four, or one: then -1
  std::array<double, 4> weight{};
  // 1/kg: sum_k weight_k² / m_k; 0: nothing here can move. Filled by weigh
  double inverse_mass = 0.0;
  Vec3 normal = Vec3::UnitZ();
  double target = 0.0;
  double lambda = 0.0;
  std::array<double, 4> share{};  // 1/kg: weight_k / m_k. Filled by weigh
  double friction = 0.0;          // mu
  // m: tangential motion over the step that friction aims at; 0 but on a moving solid
  Vec3 carried = Vec3::Zero();
  Vec3 start = Vec3::Zero();  // m: r(x0). Filled by weigh
  Vec3 tangential = Vec3::Zero();
  Vec3 pushed = Vec3::Zero();  // kg m: what it gave in all, since whoever uses that set it to 0
};

// The row's points, apart: r of these positions.
Vec3 separation(const ContactRow& row, std::span<const Vec3> x);

// x0: m, where the step began.
void weigh(ContactRow& row, std::span<const double> inverse_mass, std::span<const Vec3> x0);

// Gives the nodes what the rows begin with: lambda n + tangential. In the order of satisfy_rows.
void apply_impulses(std::span<ContactRow> rows, const RowSlabs& slabs, std::span<Vec3> x1,
                    std::span<std::uint8_t> moved);

// Meets the rows as well as `iterations` rounds of projected Gauss-Seidel can, in the order of
// `slabs`, where they are in their places, by impulses that keep momentum: x1_k += weight_k / m_k
// (dlambda n + dtangential). Only rows with a node marked in `awake` are looked at, and the nodes
// that a row moves awake: what settled before and is not disturbed stays as it is. Changes that
// would move a row's points by less than a tenth of `tolerance` (m) are not made; it ends early
// when none is greater than that. moved[k] = 1 for nodes that it moved. Source: Moreau's time
// stepping, solved as in Otaduy, Tamstorf, Steinemann & Gross 2009, "Implicit contact handling for
// deformable objects"; Bridson et al. 2002 apply each impulse once and never take it back, which in
// a stack of layers throws the upper ones off.
void satisfy_rows(std::span<ContactRow> rows, const RowSlabs& slabs, std::span<Vec3> x1,
                  std::span<std::uint8_t> awake, std::span<std::uint8_t> moved, int iterations,
                  double tolerance);

}  // namespace taut
