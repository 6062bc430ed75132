#include "taut/core/core_choice.h"

#include <algorithm>
#include <cassert>

namespace taut {

namespace {

struct Link {
  Index i, j, upper, lower;  // nodes and their two blocks
  double weight, share;      // c_ij, and relative to the lighter node
};

std::vector<Link> links_of(const BlockPattern& pattern, std::span<const double> bounds,
                           std::span<const double> masses) {
  std::vector<Link> links;
  links.reserve(static_cast<std::size_t>(pattern.blocks() - pattern.rows()) / 2);
  for (Index i = 0; i < pattern.rows(); ++i)
    for (Index k = pattern.diagonal[i] + 1; k < pattern.row_start[i + 1]; ++k) {
      const Index j = pattern.column[k];
      links.push_back(
          {i, j, k, pattern.find(j, i), bounds[k], bounds[k] / std::min(masses[i], masses[j])});
    }
  return links;
}

}  // namespace

std::vector<std::uint8_t> choose_core(const BlockPattern& pattern, std::span<const double> bounds,
                                      std::span<const double> masses, double target_rho) {
  assert(static_cast<Index>(bounds.size()) == pattern.blocks() &&
         static_cast<Index>(masses.size()) == pattern.rows());
  std::vector<Link> links = links_of(pattern, bounds, masses);
  // Among equals, node order.
  std::ranges::stable_sort(links, {}, &Link::share);
  std::vector<double> room(masses.size());
  for (std::size_t i = 0; i < room.size(); ++i) room[i] = target_rho * masses[i];
  std::vector<std::uint8_t> core(bounds.size(), 1);
  for (const Link& link : links) {
    if (!(link.weight <= std::min(room[link.i], room[link.j]))) continue;
    room[link.i] -= link.weight, room[link.j] -= link.weight;
    core[link.upper] = core[link.lower] = 0;
  }
  return core;
}

double stiffness_ratio(const BlockPattern& pattern, std::span<const double> bounds,
                       std::span<const double> masses) {
  double largest = 0.0;
  for (Index i = 0; i < pattern.rows(); ++i) {
    double sum = 0.0;
    for (Index k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k) sum += bounds[k];
    largest = std::max(largest, sum / masses[i]);
  }
  return largest;
}

}  // namespace taut
