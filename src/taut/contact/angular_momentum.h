#pragma once
// Takes back the angular momentum L that impulses between cloths have added (docs/mathematics.md,
// 7.4; docs/design/cloth-contact.md).
//
//   L = sum m x1 × v         kg m²/s
//   y = x1 - h v             m, of what was solved: x0, unless v is not (x1 - x0)/h
//   r = sum_k weight_k y_k   m, a row's points apart (contact/contact_row.h)
//   J                        kg m, h times the impulse that a row gave
//   x1 += ω × (y - c)        the turn of an island, with I ω = - sum r × J, c and I its centre of
//                            mass and inertia at y
//
// An island: rows that have pushed and share a node. The turn keeps linear momentum, restores L to
// rounding, and is the least change, sum m |Δ|², that does. Islands that hang on something held or
// on a solid keep what they have: there L goes to what holds them.

#include "taut/contact/contact_row.h"

namespace taut {

// rows: as satisfy_rows left them. mass: kg, one a vertex; inverse_mass: 1/kg, 0 where it is held.
// lever: y. Marks the nodes that it moves.
void restore_angular_momentum(std::span<const ContactRow> rows, std::span<const double> mass,
                              std::span<const double> inverse_mass, std::span<const Vec3> lever,
                              std::span<Vec3> x1, std::span<std::uint8_t> moved);

}  // namespace taut
