#pragma once
// What pushed the pairs of a surface over a step, from which the rows of the next step begin:
// layers that lie on each other press with the same forces step after step, so that Gauss-Seidel
// has little left to find (Catto 2005, "Iterative dynamics with temporal coherence").
//
//   force   N, on the first of the pair's two points: (lambda n + tangential impulse)/h² of its
//           rows (contact_row.h); a guess, so in floats
//
// A vertex and a triangle may have the same four nodes in the same order as two edges: then both
// begin with the sum.

#include <array>
#include <span>
#include <vector>

#include "taut/contact/contact_row.h"

namespace taut {

struct PairForce {
  std::array<Index, 4> node{};
  std::array<float, 3> force{};
  bool operator==(const PairForce&) const = default;
};

// Of the rows of two points of the surface that push; ascending by their first vertex, and for one
// vertex in the rows' order. h: s.
std::vector<PairForce> forces_of(std::span<const ContactRow> rows, double h, Index vertices);

// A list as above, by pairs.
class PairForces {
 public:
  PairForces(std::span<const PairForce> list, Index vertices);
  // N; 0 where nothing pushed.
  Vec3 of(const std::array<Index, 4>& node) const;

 private:
  std::span<const PairForce> list_;
  std::vector<Index> start_;  // per vertex
};

// The row begins with h² times this force: lambda with what of it pushes apart, friction with the
// rest as far as Coulomb's cone allows. Its nodes are not moved yet: apply_impulses.
void begin_with(ContactRow& row, const Vec3& force, double h);

}  // namespace taut
