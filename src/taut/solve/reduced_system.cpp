#include "taut/solve/reduced_system.h"

#include <algorithm>
#include <cassert>

#include "taut/linalg/vector_ops.h"

namespace taut {

bool ReducedSystem::update(const LinearSystem& system) {
  const bool fresh = reduction_.update(*system.matrix, system.constraints);
  update_load(system);
  return fresh;
}

void ReducedSystem::update_load(const LinearSystem& system) {
  const std::size_t n = static_cast<std::size_t>(matrix().dofs());
  assert(!system.constraints || system.constraints->free_dofs() == matrix().dofs());
  rhs_.resize(n);
  solution_.assign(n, 0.0);
  if (!system.guess.empty()) restrict_to_free(system.constraints, system.guess, solution_);
  if (!system.constraints) {
    std::copy(system.rhs.begin(), system.rhs.end(), rhs_.begin());
    return;
  }
  std::vector<double> prescribed(system.z.begin(), system.z.end());
  project_constrained(system.constraints, prescribed);
  scratch_.resize(system.rhs.size());
  multiply(*system.matrix, prescribed, scratch_);
  residual_from_product(system.rhs, scratch_);
  restrict_to_free(system.constraints, scratch_, rhs_);
}

void ReducedSystem::prolong_to(const LinearSystem& system, std::span<double> x) const {
  prolong(system.constraints, solution_, system.z, x);
}

}  // namespace taut
