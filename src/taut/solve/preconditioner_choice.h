#pragma once
// What a conjugate gradient solver is preconditioned by: how the preconditioner is made, and which
// matrix it is made from.
//
//   unconstrained   A; in full space S M_p⁻¹ S, in the reduced one Uᵀ M_p⁻¹ U. Node-wise
//                   preconditioners only: others would make a poor inverse, because their M_p⁻¹
//                   lets held nodes move
//   constrained     Ã = Uᵀ A U, in full space S A S + d (I-S)
//   core            the same of the matrix core (paper Section 6)
//   blocks          the same of A's diagonal blocks (Boxerman & Ascher 2004)
//
// Why MPCG may use the full-space forms: S A S + d (I-S) is Ã in the free directions and a diagonal
// in the others, at each node in a basis of its own. Block-wise preconditioners (block diagonal,
// IC(0), SSOR) do not depend on the basis, so theirs are U M̃ Uᵀ plus a part in the constrained
// directions, which S removes: MPCG with them takes uPCG's steps. The same for the pre-filtered
// form.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "taut/constraint/reduction.h"
#include "taut/linalg/preconditioner.h"
#include "taut/solve/linear_system.h"
#include "taut/solve/solver_options.h"

namespace taut {

enum class PreconditionerSource { unconstrained, constrained, core, blocks };

struct PreconditionerChoice {
  PreconditionerSource source = PreconditionerSource::constrained;
  // The constraints are given where they are needed: for unconstrained sources in the reduced
  // space. They need not outlive update().
  std::function<std::unique_ptr<Preconditioner>(const SolverOptions& options,
                                                const ConstraintSet* constraints)>
      make;
  bool wants_near_null_space = false;
  // In full space M_p⁻¹ takes free directions to free ones. Else its part S M_p⁻¹ S is what counts.
  bool keeps_free_directions = true;
};

// The methods that a preconditioner may be for.
enum class PcgMethod { mpcg, upcg, ppcg };

struct NamedPreconditioner {
  std::string name;
  PreconditionerChoice choice;
  std::vector<PcgMethod> methods = {PcgMethod::mpcg, PcgMethod::upcg, PcgMethod::ppcg};
};
// Those that Taut has. The first for a method is what the method's plain name means.
std::vector<NamedPreconditioner> builtin_preconditioners();

// The rigid motions of the free unknowns, S R or Uᵀ R; only translations where the system has no
// positions, empty where its nodes are not in space.
NearNullSpace near_null_space(const LinearSystem& system, bool reduced);

// Forms the source matrix and keeps its memory and pattern from one step to the next. The
// references hold until the next call.
class PreconditionerMatrix {
 public:
  const BlockCsr& reduced(const LinearSystem& system, PreconditionerSource source,
                          const BlockCsr& reduced_matrix);
  const BlockCsr& full(const LinearSystem& system, PreconditionerSource source);
  Offset bytes() const { return bytes_; }  // of what it holds itself

 private:
  Reduction part_;
  BlockCsr core_, filtered_;
  Offset bytes_ = 0;
};

// The system's core, one byte per block of A; only the diagonal blocks if it has none.
std::vector<std::uint8_t> core_mask(const LinearSystem& system);
// A matrix whose blocks of that mask are the core with the rest's diagonal, M + L_C + D_R
// (core/core.h): A itself, or `own`, which is then formed.
const BlockCsr& core_matrix(const LinearSystem& system, BlockCsr& own);

}  // namespace taut
