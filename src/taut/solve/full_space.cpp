#include "taut/solve/full_space.h"

#include "taut/linalg/vector_ops.h"

namespace taut {

namespace {

// How many nodes ahead rows of A are asked for: they lie far apart.
constexpr std::size_t nodes_ahead = 4;

}  // namespace

NodeBasis free_basis(const LinearSystem& system) {
  if (!system.constraints) return {};
  return {system.constraints->ndofs(), system.constraints->frames()};
}

void load_without_prescribed(const LinearSystem& system, std::span<double> load) {
  copy(system.rhs, load);
  if (!system.constraints) return;
  const BlockCsr& a = *system.matrix;
  const BlockPattern& p = *a.pattern;
  std::vector<std::pair<Index, Vec3>> moving;
  for_each_projected(system.constraints->ndofs(), [&](Index i) {
    const Vec3 z = system.constraints->constrained_part(
        i, Eigen::Map<const Vec3>(&system.z[3 * static_cast<std::size_t>(i)]));
    if (!z.isZero(0.0)) moving.emplace_back(i, z);
  });
  for (std::size_t m = 0; m < moving.size(); ++m) {
    if (m + nodes_ahead < moving.size()) {
      const Index later = moving[m + nodes_ahead].first;
      for (Offset k = p.value_start[later]; k < p.value_start[later + 1]; k += 8)
        __builtin_prefetch(a.values.data() + k);
    }
    // A is symmetric: its column i is its row i.
    const auto& [i, z] = moving[m];
    const Index width = p.width(i);
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
      const double* block = a.block(i, k);
      double* to = &load[static_cast<std::size_t>(p.column_dof[k])];
      for (Index c = 0; c < 3; ++c)
        to[c] -= block[c] * z.x() + block[width + c] * z.y() + block[2 * width + c] * z.z();
    }
  }
}

}  // namespace taut
