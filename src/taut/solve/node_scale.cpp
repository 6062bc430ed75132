#include "taut/solve/node_scale.h"

namespace taut {

std::vector<double> node_scale(const BlockCsr& a) {
  const BlockPattern& p = *a.pattern;
  const std::vector<double> diagonal = diagonal_of(a);
  std::vector<double> scale(static_cast<std::size_t>(p.rows()), 1.0);
  for (Index i = 0; i < p.rows(); ++i) {
    double sum = 0.0;
    for (Index r = p.dof_start[i]; r < p.dof_start[i + 1]; ++r) sum += diagonal[r];
    if (p.dim(i) > 0) scale[i] = sum / p.dim(i);
  }
  return scale;
}

}  // namespace taut
