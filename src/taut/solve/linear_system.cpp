#include "taut/solve/linear_system.h"

#include <vector>

#include "taut/constraint/reduction.h"
#include "taut/linalg/vector_ops.h"
#include "taut/solve/full_space.h"

namespace taut {

namespace {

// |S (b - A x)|
double projected_residual_norm(const LinearSystem& system, std::span<const double> x) {
  std::vector<double> r(system.rhs.size());
  multiply(*system.matrix, x, r);
  residual_from_product(system.rhs, r);
  project_free(system.constraints, r);
  return norm(r);
}

}  // namespace

double driving_norm(const LinearSystem& system) {
  std::vector<double> load(system.rhs.size());
  load_without_prescribed(system, load);
  project_free(system.constraints, load);
  return norm(load);
}

double relative_residual(const LinearSystem& system, std::span<const double> x) {
  const double scale = driving_norm(system);
  const double residual = projected_residual_norm(system, x);
  return scale > 0.0 ? residual / scale : residual;
}

}  // namespace taut
