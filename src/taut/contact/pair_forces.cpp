#include "taut/contact/pair_forces.h"

#include <algorithm>

#include "taut/base/collect.h"

namespace taut {

namespace {

constexpr Index rows_per_task = 2048;

PairForce force_of(const ContactRow& row, double h) {
  const Vec3 force = (row.lambda * row.normal + row.tangential) / (h * h);
  return {row.node,
          {static_cast<float>(force.x()), static_cast<float>(force.y()),
           static_cast<float>(force.z())}};
}

// start[v]: first entry with at least this vertex first; entries ascend by it.
std::vector<Index> starts(std::span<const PairForce> list, Index vertices) {
  std::vector<Index> start(static_cast<std::size_t>(vertices) + 1);
  for (const PairForce& entry : list) ++start[entry.node[0] + 1];
  for (Index v = 0; v < vertices; ++v) start[v + 1] += start[v];
  return start;
}

}  // namespace

std::vector<PairForce> forces_of(std::span<const ContactRow> rows, double h, Index vertices) {
  std::vector<PairForce> list;
  collect(
      static_cast<Index>(rows.size()), rows_per_task,
      [&](Index begin, Index end, std::vector<PairForce>& found) {
        for (Index k = begin; k < end; ++k)
          if (rows[k].lambda > 0.0 && rows[k].node[1] >= 0) found.push_back(force_of(rows[k], h));
      },
      list);
  std::vector<Index> next = starts(list, vertices);
  std::vector<PairForce> ordered(list.size());
  for (const PairForce& entry : list) ordered[next[entry.node[0]]++] = entry;
  return ordered;
}

PairForces::PairForces(std::span<const PairForce> list, Index vertices)
    : list_(list), start_(starts(list, vertices)) {}

Vec3 PairForces::of(const std::array<Index, 4>& node) const {
  Vec3 sum = Vec3::Zero();
  for (Index k = start_[node[0]]; k < start_[node[0] + 1]; ++k)
    if (list_[k].node == node) sum += Vec3(list_[k].force[0], list_[k].force[1], list_[k].force[2]);
  return sum;
}

void begin_with(ContactRow& row, const Vec3& force, double h) {
  const Vec3 impulse = h * h * force;
  const double along = row.normal.dot(impulse);
  if (!(along > 0.0) || !impulse.allFinite() || row.inverse_mass == 0.0) return;
  row.lambda = along;
  row.tangential = impulse - along * row.normal;
  const double size = row.tangential.norm(), limit = row.friction * row.lambda;
  if (size > limit) row.tangential *= limit / size;
}

}  // namespace taut
