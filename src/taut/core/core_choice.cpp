#include "taut/core/core_choice.h"

#include <algorithm>
#include <cassert>
#include <limits>

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

double share_of(const LargerElement& e, std::span<const double> masses) {
  double largest = 0.0;
  for (Index k = 0; k < e.nodes; ++k) largest = std::max(largest, e.weight[k] / masses[e.node[k]]);
  return largest;
}

}  // namespace

std::vector<std::uint8_t> choose_core(const BlockPattern& pattern, std::span<const double> bounds,
                                      std::span<const double> masses, double target_rho,
                                      std::span<const LargerElement> larger) {
  assert(static_cast<Index>(bounds.size()) == pattern.blocks() &&
         static_cast<Index>(masses.size()) == pattern.rows());
  std::vector<Link> links = links_of(pattern, bounds, masses);
  std::vector<LargerElement> elements(larger.begin(), larger.end());
  const auto share = [&](const LargerElement& e) { return share_of(e, masses); };
  // Among equals, node order; links before elements.
  std::ranges::stable_sort(links, {}, &Link::share);
  std::ranges::stable_sort(elements, {}, share);
  std::vector<double> room(masses.size());
  for (std::size_t i = 0; i < room.size(); ++i) room[i] = target_rho * masses[i];
  std::vector<std::uint8_t> core(bounds.size(), 1);
  const auto leave_link_out = [&](const Link& link) {
    if (!(link.weight <= std::min(room[link.i], room[link.j]))) return;
    room[link.i] -= link.weight, room[link.j] -= link.weight;
    core[link.upper] = core[link.lower] = 0;
  };
  const auto leaves_element_out = [&](const LargerElement& e) {
    for (Index k = 0; k < e.nodes; ++k)
      if (!(e.weight[k] <= room[e.node[k]])) return false;
    for (Index k = 0; k < e.nodes; ++k) room[e.node[k]] -= e.weight[k];
    return true;
  };
  std::vector<const LargerElement*> kept;
  auto link = links.begin();
  const auto leave_links_out = [&](double largest_share) {
    for (; link != links.end() && link->share <= largest_share; ++link) leave_link_out(*link);
  };
  for (const LargerElement& e : elements) {
    leave_links_out(share(e));
    if (!leaves_element_out(e)) kept.push_back(&e);
  }
  leave_links_out(std::numeric_limits<double>::infinity());
  for (const LargerElement* e : kept)
    for (Index a = 0; a < e->nodes; ++a)
      for (Index b = 0; b < e->nodes; ++b) core[pattern.find(e->node[a], e->node[b])] = 1;
  return core;
}

double stiffness_ratio(const BlockPattern& pattern, std::span<const double> bounds,
                       std::span<const double> masses, std::span<const LargerElement> larger) {
  std::vector<double> sum(masses.size(), 0.0);
  for (Index i = 0; i < pattern.rows(); ++i)
    for (Index k = pattern.row_start[i]; k < pattern.row_start[i + 1]; ++k) sum[i] += bounds[k];
  for (const LargerElement& e : larger)
    for (Index k = 0; k < e.nodes; ++k) sum[e.node[k]] += e.weight[k];
  double largest = 0.0;
  for (std::size_t i = 0; i < sum.size(); ++i) largest = std::max(largest, sum[i] / masses[i]);
  return largest;
}

}  // namespace taut
