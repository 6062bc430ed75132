#pragma once
// A force model: many small elements of the same kind (springs, hinges), each coupling the nodes of
// its stencil.
//
//   f = -grad E,   K = -df/dx as used,   D = -df/dv        N, N/m, N s/m
//   matrix block   damping * D + stiffness * K
//   vector         force * f + (K p) + (D q)               p, q: node fields of the integrator
//
// So each element is visited once a step. Of each element the matrix E is positive semidefinite and
// its block rows sum to zero, since a translation costs nothing: on that the bounds of cores rest
// (docs/mathematics.md, 5).
//
// Numbers come in two flat arrays; where they go in the matrix, with which sign, is said once, in
// `connect`. A new model: its header and source, one line in sim/cloth_model.cpp, one test file.

#include <span>
#include <string>

#include "taut/base/types.h"

namespace taut {

// The core is chosen by class and strength (docs/mathematics.md, 5).
enum class ForceClass { stretch, shear, bend, contact };
const char* name_of(ForceClass force_class);

// What the integrator wants to know of every element.
struct ForceRequest {
  std::span<const Vec3> x;                  // m
  std::span<const Vec3> v;                  // m/s
  double matrix_stiffness = 0.0;            // factor of K in the matrix
  double matrix_damping = 0.0;              // factor of D in the matrix
  double force = 1.0;                       // factor of f in the vector
  std::span<const Vec3> stiffness_operand;  // p; empty: no K p
  std::span<const Vec3> damping_operand;    // q; empty: no D q
  bool wants_matrix() const { return matrix_stiffness != 0.0 || matrix_damping != 0.0; }
};

// Receives a model's connections; ids count the model's own blocks and vectors from 0.
class ConnectionSink {
 public:
  virtual ~ConnectionSink() = default;
  // Block `id` (row-major 3x3), times `sign`, transposed if asked, is added at (row, column).
  virtual void matrix(Index id, Index row, Index column, int sign, bool transposed) = 0;
  // Vector `id`, times `sign`, is added at `node`.
  virtual void vector(Index id, Index node, int sign) = 0;
};

class ForceModel {
 public:
  virtual ~ForceModel() = default;
  virtual ForceClass force_class() const = 0;
  // Whether the step it was made for may leave it out of the matrix (explicit_split.h).
  virtual bool stable_explicitly() const { return false; }
  // q, the same for all elements.
  virtual Index nodes_per_element() const = 0;
  // Blocks are numbered element by element.
  virtual Index blocks_per_element() const = 0;
  virtual Index block_count() const = 0;
  virtual Index vector_count() const = 0;
  virtual void connect(ConnectionSink& sink) const = 0;
  // blocks: 9 * block_count() doubles, left alone unless the request wants a matrix; vectors:
  // vector_count() entries. Parallel inside.
  virtual void evaluate(const ForceRequest& request, std::span<double> blocks,
                        std::span<Vec3> vectors) const = 0;
  // For each block b of matrix_stiffness K + matrix_damping D: a bound on its norm that
  // holds in every state (block_count() entries). The core is chosen by it, so that the choice
  // stays while the cloth moves.
  virtual void bound_blocks(double matrix_stiffness, double matrix_damping,
                            std::span<double> bounds) const = 0;
  // J
  virtual double energy(std::span<const Vec3> x) const = 0;
  // Elements with no direction left (both ends in one place): they give no force and no stiffness,
  // and are counted.
  virtual Index collapsed(std::span<const Vec3> x) const = 0;
};

}  // namespace taut
