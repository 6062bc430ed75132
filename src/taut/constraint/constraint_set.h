#pragma once
// Per-node constraints of one step: which directions of a node are prescribed, and how far it moves
// along them (docs/mathematics.md, 3; paper Eq. 3, 4, 12). Nothing downstream of this type asks
// where a constraint came from.
//
//   ndof(i)          3, 2, 1 or 0 free directions of node i
//   U_i              3 x ndof, orthonormal columns spanning the free directions; S_i = U_i U_iᵀ
//   displacement(i)  (I - S_i) d, m: the prescribed motion over this step
//   z_i              the prescribed part of the integrator's unknown, made from displacement(i) by
//                    the integrator
//
// `constrain(i, n, distance)` says n·(x_end - x_start) = distance; d solves this for all directions
// n of a node, which need not be orthogonal, nor of length 1. A direction that adds less than
// `parallel_tolerance` to the span of the earlier ones is merged with them and its distance
// ignored: two nearly parallel normals cannot both be met exactly. `fix(i, d)` prescribes all
// three. Why displacements: docs/architecture.md, Constraints.

#include <array>
#include <span>
#include <vector>

#include "taut/base/types.h"

namespace taut {

// sin of the angle below which two normals count as one: beyond it the solution for z would amplify
// errors of distance a thousandfold.
constexpr double parallel_tolerance = 1e-3;

// How the two free directions of an ndof = 2 node are chosen. All span the same plane: only
// preconditioners that are not block-wise see a difference.
enum class FrameChoice {
  duff,  // Duff et al. 2017, "Building an orthonormal basis, revisited": no bad direction
  // the paper's closed form, its "otherwise" case repaired; loses digits near |p1| = 1, exact
  // at both poles
  paper_eq13
};

// Two orthonormal vectors orthogonal to the unit vector n.
std::array<Vec3, 2> orthonormal_complement(const Vec3& n, FrameChoice choice = FrameChoice::duff);

class ConstraintSet {
 public:
  ConstraintSet() = default;
  explicit ConstraintSet(Index nodes, FrameChoice choice = FrameChoice::duff) {
    reset(nodes, choice);
  }
  // All nodes free.
  void reset(Index nodes, FrameChoice choice = FrameChoice::duff);

  // n·d = distance (m). n must be finite and not zero (asserted).
  void constrain(Index node, const Vec3& n, double distance);
  // d = displacement (m).
  void fix(Index node, const Vec3& displacement);
  // A node whose U_i is known already (read from a file): the first `ndof` columns of the rotation
  // `frame`. d = 0. With ndof 3 or 0 the frame is I.
  void set_frame(Index node, int ndof, const Mat3& frame);

  Index nodes() const { return static_cast<Index>(ndof_.size()); }
  int ndof(Index i) const { return ndof_[i]; }
  std::span<const std::int8_t> ndofs() const { return ndof_; }
  // Columns of U_i: the first ndof(i) columns of this matrix; the others complete it to an
  // orthogonal matrix and span the constrained directions.
  const Mat3& frame(Index i) const { return frame_[i]; }
  std::span<const Mat3> frames() const { return frame_; }
  const Vec3& displacement(Index i) const { return displacement_[i]; }
  // S_i, exactly I or 0 for ndof 3 or 0.
  Mat3 projection(Index i) const;
  // S_i a: the free part of a.
  Vec3 free_part(Index i, const Vec3& a) const;
  Vec3 constrained_part(Index i, const Vec3& a) const { return a - free_part(i, a); }
  // 3N minus the number of prescribed directions.
  Index free_dofs() const;
  Index constrained_dofs() const { return 3 * nodes() - free_dofs(); }
  bool same_pattern(const ConstraintSet& other) const { return ndof_ == other.ndof_; }

 private:
  std::vector<std::int8_t> ndof_;
  std::vector<Mat3> frame_;
  std::vector<Vec3> displacement_;
  FrameChoice choice_ = FrameChoice::duff;
};

}  // namespace taut
