#pragma once
// Whether parallelograms should stand in for springs outside the core, or these be left out
// (docs/mathematics.md, 5). What is wrong with P then is, for a motion x,
//
//   left out   Σ B(x_a - x_c)                  B = -A_ac, B(u) = uᵀ B u
//   replaced   Σ B(x_a - x_b + x_c - x_d)      0 for affine motions, but up to four times as much
//                                              for those that change sign from node to node
//
// It is asked of last step's x, which is as smooth as the next one mostly, and of some hundred
// parallelograms.

#include <span>

#include "taut/linalg/parallelogram.h"

namespace taut {

// x: 3N doubles. False if x is nothing there. Same answer for any number of threads.
bool replacing_pays(const BlockCsr& a, std::span<const Parallelogram> parallelograms,
                    std::span<const double> x);

}  // namespace taut
