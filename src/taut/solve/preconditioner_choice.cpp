#include "taut/solve/preconditioner_choice.h"

#include <cassert>

#include "taut/base/parallel.h"
#include "taut/linalg/incomplete_cholesky.h"
#include "taut/linalg/smoothed_aggregation.h"
#include "taut/linalg/ssor.h"
#include "taut/solve/filtered_matrix.h"
#include "taut/solve/node_preconditioner.h"

namespace taut {

namespace {

template <NodeDiagonal kind>
std::unique_ptr<Preconditioner> make_projected(const SolverOptions&,
                                               const ConstraintSet* constraints) {
  return std::make_unique<ProjectedNodePreconditioner>(kind, constraints);
}

template <class Made>
std::unique_ptr<Preconditioner> make_plain(const SolverOptions&, const ConstraintSet*) {
  return std::make_unique<Made>();
}

std::unique_ptr<Preconditioner> make_ssor(const SolverOptions& options, const ConstraintSet*) {
  return std::make_unique<BlockSsor>(options.ssor_omega);
}

}  // namespace

std::vector<NamedPreconditioner> builtin_preconditioners() {
  using enum PreconditionerSource;
  using enum PcgMethod;
  const PreconditionerChoice diagonal{unconstrained, make_projected<NodeDiagonal::scalar>},
      block_diagonal{unconstrained, make_projected<NodeDiagonal::block>},
      reduced_diagonal{blocks, make_plain<DiagonalPreconditioner>},
      projected_block_diagonal{blocks, make_plain<BlockDiagonalPreconditioner>},
      ic0{constrained, make_plain<BlockIncompleteCholesky>},
      ic0_core{core, make_plain<BlockIncompleteCholesky>}, ssor{constrained, make_ssor},
      amg{constrained, make_plain<SmoothedAggregation>, true};
  return {
      {"diagonal", diagonal, {mpcg, upcg}},
      {"block_diagonal", block_diagonal, {mpcg, upcg}},
      {"block_diagonal", projected_block_diagonal, {ppcg}},
      // depends on the choice of U
      {"reduced_diagonal", reduced_diagonal, {upcg}},
      {"projected_block_diagonal", projected_block_diagonal, {mpcg, upcg}},
      {"ic0", ic0, {mpcg, upcg, ppcg}},
      {"ic0_core", ic0_core, {mpcg, upcg, ppcg}},
      {"ssor", ssor, {mpcg, upcg, ppcg}},
      // not block-wise: for the methods that take it as it is
      {"amg", amg, {upcg, ppcg}},
  };
}

std::vector<std::uint8_t> core_mask(const LinearSystem& system) {
  std::vector<std::uint8_t> mask(system.core.mask.begin(), system.core.mask.end());
  if (mask.empty()) mask.assign(static_cast<std::size_t>(system.matrix->pattern->blocks()), 0);
  assert(static_cast<Index>(mask.size()) == system.matrix->pattern->blocks());
  return mask;
}

const BlockCsr& core_matrix(const LinearSystem& system, BlockCsr& own) {
  if (!system.core.matrix) return *system.matrix;
  own = *system.core.matrix;
  const BlockPattern& p = *own.pattern;
  assert(p.uniform_dim == 3 && static_cast<Index>(system.core.rest_diagonal.size()) == p.rows());
  parallel_for(p.rows(), 512, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      for (Index r = 0; r < 3; ++r)
        for (Index c = 0; c < 3; ++c)
          own.block(i, p.diagonal[i])[r * p.width(i) + c] += system.core.rest_diagonal[i](r, c);
  });
  return own;
}

NearNullSpace near_null_space(const LinearSystem& system, bool reduced) {
  const BlockPattern& p = *system.matrix->pattern;
  if (p.uniform_dim != 3) return {};
  NearNullSpace space = rigid_motions(p.rows(), system.positions);
  if (!system.constraints) return space;
  const std::size_t modes = static_cast<std::size_t>(space.modes),
                    n = static_cast<std::size_t>(p.dofs());
  const std::size_t rows = reduced ? static_cast<std::size_t>(system.constraints->free_dofs()) : n;
  NearNullSpace result{space.modes, std::vector<double>(rows * modes)};
  std::vector<double> full(n), part(rows);
  for (std::size_t m = 0; m < modes; ++m) {
    for (std::size_t r = 0; r < n; ++r) full[r] = space.values[r * modes + m];
    reduced ? restrict_to_free(system.constraints, full, part)
            : project_free(system.constraints, full);
    const std::vector<double>& mode = reduced ? part : full;
    for (std::size_t r = 0; r < rows; ++r) result.values[r * modes + m] = mode[r];
  }
  return result;
}

const BlockCsr& PreconditionerMatrix::reduced(const LinearSystem& system,
                                              PreconditionerSource source,
                                              const BlockCsr& reduced_matrix) {
  bytes_ = 0;
  if (source == PreconditionerSource::unconstrained) return *system.matrix;
  // node-wise ones read the diagonal blocks only
  if (source != PreconditionerSource::core) return reduced_matrix;
  part_.update(core_matrix(system, core_), system.constraints, core_mask(system));
  bytes_ = part_.matrix().bytes();
  return part_.matrix();
}

const BlockCsr& PreconditionerMatrix::full(const LinearSystem& system,
                                           PreconditionerSource source) {
  bytes_ = 0;
  const BlockCsr* matrix = system.matrix;
  if (source == PreconditionerSource::unconstrained) return *matrix;
  if (source != PreconditionerSource::constrained) {
    LinearSystem part = system;
    if (source != PreconditionerSource::core) part.core = {};
    part_.update(core_matrix(part, core_), nullptr, core_mask(part));
    matrix = &part_.matrix();
    bytes_ += matrix->bytes();
  }
  if (!system.constraints) return *matrix;
  filter_matrix(*matrix, system.constraints, filtered_);
  bytes_ += filtered_.bytes();
  return filtered_;
}

}  // namespace taut
