#include "taut/solve/solver_work.h"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

// Share of the blocks outside a sheet's core that have no place in its factor, measured on grids.
constexpr double outside_fill = 0.31;

}  // namespace

SystemSize size_of(const LinearSystem& system) {
  const BlockPattern& p = *system.matrix->pattern;
  SystemSize size;
  size.unknowns = system.constraints ? system.constraints->free_dofs() : p.dofs();
  size.nodes = p.rows() * (size.unknowns / std::max(1.0, static_cast<double>(p.dofs())));
  // Held nodes lie side by side, so what they take away goes with their number.
  const double free = size.unknowns / std::max(1.0, static_cast<double>(p.dofs()));
  const double per_block = static_cast<double>(p.value_count()) / std::max<Index>(1, p.blocks());
  const auto blocks_of = [](std::span<const std::uint8_t> core) {
    return static_cast<double>(std::ranges::count(core, std::uint8_t{1}));
  };
  const double core_blocks = system.core.mask.empty() ? p.rows() : blocks_of(system.core.mask);
  size.nonzeros = free * static_cast<double>(p.value_count());
  size.core_nonzeros = free * core_blocks * per_block;
  for (const Core& core : system.other_cores)
    size.other_core_nonzeros.push_back(free * blocks_of(core.mask) * per_block);
  return size;
}

FactorSize estimate_factor(const SystemSize& size, double nonzeros) {
  const double n = std::max(2.0, size.nodes), area = std::pow(size.unknowns / n, 2);
  const double neighbours = nonzeros / (area * n) - 1.0;
  if (neighbours < 0.5) return {size.unknowns, size.unknowns, size.nonzeros - nonzeros};
  const double width = neighbours / 4.0;
  return {1.4 * std::pow(width, 1.12) * area * n * std::log2(n),
          8.5 * std::pow(width, 1.75) * area * (size.unknowns / n) * std::pow(n, 1.5),
          outside_fill * (size.nonzeros - nonzeros)};
}

namespace {

// Bytes of a number of a 3x3 block with its share of the block's place: in A, and outside the core
// (core/block_remainder.h).
constexpr double in_matrix = 8.5, outside_core = 4.9;

// A product that reads so many bytes, and the loop's dot products and updates.
double loop_work(const SystemSize& size, double product_bytes) {
  return work_rates.stream * (product_bytes + (16.0 + 100.0) * size.unknowns);
}

// What is left out of the core is copied first.
double copy_work(const SystemSize& size, const FactorSize& factor) {
  return work_rates.stream * (8.0 * size.nonzeros + outside_core * factor.left_out);
}

double reduction_work(const SystemSize& size) { return work_rates.reduce * 8.0 * size.nonzeros; }

double factor_solve_work(const SystemSize& size, const FactorSize& factor) {
  return work_rates.factor_solve * factor.nonzeros + work_rates.factor_node * size.nodes;
}

}  // namespace

MethodWork block_diagonal_work(const SystemSize& size) {
  return {reduction_work(size) + work_rates.stream * 60.0 * size.unknowns,
          loop_work(size, in_matrix * size.nonzeros) + work_rates.stream * 40.0 * size.unknowns};
}

MethodWork incomplete_work(const SystemSize& size, double nonzeros, double preparations) {
  return {reduction_work(size) + preparations * work_rates.incomplete_setup * 8.0 * nonzeros,
          loop_work(size, in_matrix * size.nonzeros) + work_rates.incomplete * 8.0 * nonzeros};
}

MethodWork core_work(const SystemSize& size, const FactorSize& factor, double preparations) {
  const double once =
      0.5 * (work_rates.factor * factor.flops + work_rates.factor_entry * factor.nonzeros);
  return {copy_work(size, factor) + once * (1.0 + 2.0 * (preparations - 1.0)),
          loop_work(size, outside_core * factor.left_out) + factor_solve_work(size, factor)};
}

MethodWork direct_work(const FactorSize& factor) {
  return {work_rates.factor * factor.flops +
              (work_rates.factor_entry + 2.0 * work_rates.factor_solve) * factor.nonzeros,
          0.0};
}

}  // namespace taut
