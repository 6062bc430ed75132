#include "taut/contact/contact_row.h"

#include <algorithm>
#include <cmath>

#include "taut/base/parallel.h"

namespace taut {

namespace {

// Of the tolerance: what is not worth that a node's pairs are searched again.
constexpr double negligible = 0.1;

// A row's nodes while it is met: `Count` of them.
template <std::size_t Count>
struct RowNodes {
  ContactRow& row;
  std::array<Vec3, Count> x;

  RowNodes(ContactRow& the_row, std::span<const Vec3> x1) : row(the_row) {
    for (std::size_t k = 0; k < Count; ++k) x[k] = x1[row.node[k]];
  }
  Vec3 separation() const {
    Vec3 sum = row.weight[0] * x[0];
    for (std::size_t k = 1; k < Count; ++k) sum += row.weight[k] * x[k];
    return sum;
  }
  void push(const Vec3& impulse) {
    row.pushed += impulse;
    for (std::size_t k = 0; k < Count; ++k) x[k] += row.share[k] * impulse;
  }
  void store(std::span<Vec3> x1, std::span<std::uint8_t> moved) const {
    for (std::size_t k = 0; k < Count; ++k) {
      if (row.share[k] == 0.0) continue;
      x1[row.node[k]] = x[k];
      if (!moved[row.node[k]]) moved[row.node[k]] = 1;
    }
  }
};

// f(nodes)
template <class Function>
auto with_nodes(ContactRow& row, std::span<const Vec3> x1, const Function& f) {
  return row.node[1] < 0 ? f(RowNodes<1>(row, x1)) : f(RowNodes<4>(row, x1));
}

// What friction adds to bring the tangential motion to that of the other
// side, within Coulomb's cone.
Vec3 friction_step(const ContactRow& row, const Vec3& r, double mass) {
  const Vec3 motion = r - row.start - row.carried;
  const Vec3 slip = motion - row.normal.dot(motion) * row.normal;
  Vec3 wanted = row.tangential - mass * slip;
  const double limit = row.friction * row.lambda, size2 = wanted.squaredNorm();
  if (size2 > limit * limit) wanted *= limit / std::sqrt(size2);
  return wanted - row.tangential;
}

// Returns how far the row's points moved against one another.
template <class Nodes>
double satisfy(Nodes nodes, std::span<Vec3> x1, std::span<std::uint8_t> moved, double tolerance) {
  ContactRow& row = nodes.row;
  const double missing = row.target - row.normal.dot(nodes.separation()),
               mass = 1.0 / row.inverse_mass;
  const double lambda = std::max(0.0, row.lambda + missing * mass);
  if (lambda == 0.0 && row.lambda == 0.0) return 0.0;
  double motion = std::abs(lambda - row.lambda) * row.inverse_mass;
  if (motion > negligible * tolerance) {
    nodes.push((lambda - row.lambda) * row.normal);
    row.lambda = lambda;
  } else {
    motion = 0.0;
  }
  if (row.friction != 0.0) {
    const Vec3 tangential = friction_step(row, nodes.separation(), mass);
    const double sideways = tangential.norm() * row.inverse_mass;
    if (sideways > negligible * tolerance) {
      row.tangential += tangential;
      nodes.push(tangential);
      motion = std::max(motion, sideways);
    }
  }
  if (motion > 0.0) nodes.store(x1, moved);
  return motion;
}

bool is_awake(const ContactRow& row, std::span<const std::uint8_t> awake) {
  for (std::size_t k = 0; k < 4 && row.node[k] >= 0; ++k)
    if (awake[row.node[k]]) return true;
  return false;
}

void wake(const ContactRow& row, std::span<std::uint8_t> awake) {
  for (std::size_t k = 0; k < 4 && row.node[k] >= 0; ++k)
    // not written needlessly: threads share the line
    if (!awake[row.node[k]]) awake[row.node[k]] = 1;
}

// In this order. Returns the largest motion of any.
double satisfy_group(std::span<ContactRow> group, std::span<Vec3> x1, std::span<std::uint8_t> awake,
                     std::span<std::uint8_t> moved, double tolerance) {
  double largest = 0.0;
  for (ContactRow& row : group) {
    if (row.inverse_mass == 0.0 || !is_awake(row, awake)) continue;
    const double motion = with_nodes(
        row, x1, [&](const auto& nodes) { return satisfy(nodes, x1, moved, tolerance); });
    if (motion > 0.0) wake(row, awake);
    largest = std::max(largest, motion);
  }
  return largest;
}

}  // namespace

Vec3 separation(const ContactRow& row, std::span<const Vec3> x) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < 4 && row.node[k] >= 0; ++k) sum += row.weight[k] * x[row.node[k]];
  return sum;
}

void weigh(ContactRow& row, std::span<const double> inverse_mass, std::span<const Vec3> x0) {
  row.inverse_mass = 0.0;
  for (std::size_t k = 0; k < 4 && row.node[k] >= 0; ++k) {
    row.inverse_mass += row.weight[k] * row.weight[k] * inverse_mass[row.node[k]];
    row.share[k] = row.weight[k] * inverse_mass[row.node[k]];
  }
  row.start = separation(row, x0);
}

namespace {

// The groups of the rows, phase after phase: f(g, rows) with all groups of
// a phase at the same time.
template <class Function>
void for_groups(std::span<ContactRow> rows, const RowSlabs& slabs, const Function& f) {
  for (Index phase = 0; phase < RowSlabs::phases; ++phase) {
    const Index first = slabs.first_group(phase);
    parallel_for(slabs.first_group(phase + 1) - first, 1, [&](Index begin, Index end) {
      for (Index g = first + begin; g < first + end; ++g) {
        const Index stop =
            g + 1 == RowSlabs::groups ? static_cast<Index>(rows.size()) : slabs.start(g + 1);
        f(g, rows.subspan(slabs.start(g), stop - slabs.start(g)));
      }
    });
  }
}

}  // namespace

void apply_impulses(std::span<ContactRow> rows, const RowSlabs& slabs, std::span<Vec3> x1,
                    std::span<std::uint8_t> moved) {
  for_groups(rows, slabs, [&](Index, std::span<ContactRow> group) {
    for (ContactRow& row : group) {
      if (row.lambda == 0.0) continue;
      with_nodes(row, x1, [&](auto nodes) {
        nodes.push(row.lambda * row.normal + row.tangential);
        nodes.store(x1, moved);
      });
    }
  });
}

void satisfy_rows(std::span<ContactRow> rows, const RowSlabs& slabs, std::span<Vec3> x1,
                  std::span<std::uint8_t> awake, std::span<std::uint8_t> moved, int iterations,
                  double tolerance) {
  std::array<double, RowSlabs::groups> motion;
  for (int k = 0; k < iterations; ++k) {
    for_groups(rows, slabs, [&](Index g, std::span<ContactRow> group) {
      motion[g] = satisfy_group(group, x1, awake, moved, tolerance);
    });
    if (*std::ranges::max_element(motion) <= tolerance) return;
  }
}

}  // namespace taut
