#pragma once
// Puts the force models' elements together into A (3x3 blocks) and the right-hand side.
//
//   A_ij   sum of the matrix blocks of the elements that couple i and j,
//          and for i = j also m_i mass + external D_ext,i
//   b_i    sum of the elements' vectors at i
//
// The pattern is that of the *implicit* models (IMEX leaves shear and bend out: the "thin matrix")
// and is built once. Each step, elements are evaluated in parallel into flat arrays and then
// gathered block row by block row, in the order of the models' connections: parallel, no atomics,
// the same bits for any thread count, nothing allocated. What only some elements add, those of a
// core or the rest, is gathered from the same arrays afterwards.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>

#include "taut/element/force_model.h"
#include "taut/linalg/block_csr.h"

namespace taut {

// The elements of a core are those whose blocks off the diagonal are all in its mask; the others
// are the rest, which the core leaves out whole.
struct CoreElements {
  Index inside = 0;         // how many are in the core
  Index nodes_outside = 0;  // q: nodes of the largest element of the rest; 0: there is none
  std::vector<std::uint8_t> is_outside;  // per block of the flat arrays: of the rest
};

// One of more than two nodes, and bounds on the norms of its diagonal blocks, one a node.
struct LargerElement {
  static constexpr Index most_nodes = 4;
  Index nodes = 0;
  std::array<Index, most_nodes> node{};
  std::array<double, most_nodes> weight{};
};

class Assembler {
 public:
  // models: not owned, must outlive this. implicit[m] says whether model m enters the matrix.
  Assembler(Index nodes, std::vector<const ForceModel*> models, std::vector<bool> implicit);

  const std::shared_ptr<const BlockPattern>& pattern() const { return pattern_; }
  std::span<const ForceModel* const> models() const { return models_; }
  bool is_implicit(std::size_t model) const { return implicit_[model]; }

  // 1 for each block of the pattern that a model of `core_class` fills, and for the diagonal (paper
  // Section 6: A_core keeps these).
  std::vector<std::uint8_t> core_mask(ForceClass core_class) const;

  // For each block of the pattern off the diagonal, a bound on the norm of what the elements of two
  // nodes add to it with these factors of K and D, in whatever state; 0 on the diagonal.
  std::vector<double> block_bounds(double matrix_stiffness, double matrix_damping) const;
  // The same of the larger elements, for their diagonal blocks.
  std::vector<LargerElement> larger_elements(double matrix_stiffness, double matrix_damping) const;
  CoreElements elements_of(std::span<const std::uint8_t> mask) const;

  struct Diagonal {
    std::span<const double> masses;  // kg
    double mass = 1.0;               // factor
    std::span<const Mat3> damping;   // D_ext, or empty
    double external = 0.0;           // factor
  };
  // requests: one per model. Overwrites a (same pattern) and b (one entry per node). Explicit
  // models must not ask for a matrix (asserted).
  void assemble(std::span<const ForceRequest> requests, const Diagonal& diagonal, BlockCsr& a,
                std::span<Vec3> b);

  // Of the last assemble(), whose masses and damping must still be there: D_R, the diagonal blocks
  // of the rest, one a node ...
  void gather_rest_diagonal(const CoreElements& core, std::span<Mat3> diagonal) const;
  // ... and the matrix without the rest (a's pattern).
  void gather_core(const CoreElements& core, BlockCsr& matrix) const;

 private:
  struct Contribution {  // block or vector `id` of the flat arrays, with sign and transposition
    std::uint32_t bits;
    Index id() const { return static_cast<Index>(bits >> 2); }
    bool negative() const { return bits & 1u; }
    bool transposed() const { return bits & 2u; }
  };
  std::vector<double> own_bounds(double matrix_stiffness, double matrix_damping) const;
  bool has_larger_elements(std::size_t model) const {
    return implicit_[model] && models_[model]->nodes_per_element() > 2;
  }
  void build_pattern(Index nodes);
  void build_gather(Index nodes);
  template <class IsTaken>
  void gather_row(Index i, IsTaken is_taken, BlockCsr& a) const;

  std::vector<const ForceModel*> models_;
  std::vector<bool> implicit_;
  std::shared_ptr<const BlockPattern> pattern_;
  // where each model's part of the flat arrays begins
  std::vector<Index> block_base_, vector_base_;
  // gather lists, per block of the pattern and per node
  std::vector<Index> block_start_, vector_start_;
  std::vector<Contribution> block_list_, vector_list_;
  std::vector<double> blocks_;
  std::vector<Vec3> vectors_;
  Diagonal diagonal_;  // of the last assemble()
};

}  // namespace taut
