#pragma once
// Takes back the angular momentum that impulses between cloths have added.
//
//   L = sum m x1 × v                  kg m²/s
//   y = x1 - h v                      m, of what was solved: x0, but of integrators whose v is not
//                                     (x1 - x0)/h
//   Δ                                 m: what the response adds to x1, and Δ/h to v. It leaves L as
//                                     it is when sum m y × Δ = 0, since (x1 + Δ) × (v + Δ/h) = x1 ×
//                                     v + y × Δ/h
//   r = sum_k weight_k y_k            m, a row's points apart (contact_row.h)
//   J                                 kg m, h times the impulse that a row gave
//
// A row changes h L by r × J: nothing where it pushes along the line through its points at y
// (repulsion without friction). A collision pushes along the line at the time of impact, and
// friction across it. Rows that have pushed and share a node make an island. Each island gets the
// turn
//
//   x1 += ω × (y - c),    I ω = - sum r × J,    c and I: its centre of mass and inertia at y
//
// which keeps linear momentum and restores L to rounding. It is the least change that does, sum m
// |Δ|²: it takes the rigid turn out of what the rows did. Islands that hang on something held or on
// a solid keep what they have: there L goes to what holds them.
//
// It may spoil rows, or let pairs collide: it comes before the search that proves the way free
// (contact/cloth_contact.h), like the rows.

#include "taut/contact/contact_row.h"

namespace taut {

// rows: as satisfy_rows left them. mass: kg, one a vertex; inverse_mass: 1/kg, 0 where it is held.
// lever: y. Marks the nodes that it moves.
void restore_angular_momentum(std::span<const ContactRow> rows, std::span<const double> mass,
                              std::span<const double> inverse_mass, std::span<const Vec3> lever,
                              std::span<Vec3> x1, std::span<std::uint8_t> moved);

}  // namespace taut
