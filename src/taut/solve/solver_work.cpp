#include "taut/solve/solver_work.h"

#include <algorithm>
#include <cmath>

namespace taut {

SystemSize size_of(const LinearSystem& system) {
  const BlockPattern& p = *system.matrix->pattern;
  SystemSize size;
  size.unknowns = system.constraints ? system.constraints->free_dofs() : p.dofs();
  size.nodes = p.rows() * (size.unknowns / std::max(1.0, static_cast<double>(p.dofs())));
  // Held nodes lie side by side, so what they take away goes with their number.
  const double free = size.unknowns / std::max(1.0, static_cast<double>(p.dofs()));
  const double per_block = static_cast<double>(p.value_count()) / std::max<Index>(1, p.blocks());
  const auto blocks_of = [](std::span<const std::uint8_t> core) { return static_cast<double>(std::ranges::count(core, std::uint8_t{1})); };
  const double core_blocks = system.core.empty() ? p.rows() : blocks_of(system.core);
  size.nonzeros = free * static_cast<double>(p.value_count());
  size.core_nonzeros = free * core_blocks * per_block;
  size.stretch_core_nonzeros = free * blocks_of(system.stretch_core) * per_block;
  return size;
}

FactorSize estimate_factor(const SystemSize& size, double nonzeros) {
  const double n = std::max(2.0, size.nodes), area = std::pow(size.unknowns / n, 2);
  const double neighbours = nonzeros / (area * n) - 1.0;
  if (neighbours < 0.5) return {size.unknowns, size.unknowns};
  const double width = neighbours > 8.5 ? 2.0 : 1.0;
  return {2.2 * width * area * n * std::log2(n), 12.0 * std::pow(width, 3) * area * (size.unknowns / n) * std::pow(n, 1.5)};
}

namespace {

// Product with Ã, and the loop's dot products and updates.
double loop_work(const SystemSize& size) { return work_rates.stream * (8.5 * size.nonzeros + (16.0 + 100.0) * size.unknowns); }

}  // namespace

MethodWork block_diagonal_work(const SystemSize& size) {
  return {work_rates.stream * 60.0 * size.unknowns, loop_work(size) + work_rates.stream * 40.0 * size.unknowns};
}

MethodWork incomplete_work(const SystemSize& size, double nonzeros, double preparations) {
  return {preparations * work_rates.incomplete_setup * 8.0 * nonzeros, loop_work(size) + work_rates.incomplete * 8.0 * nonzeros};
}

MethodWork core_work(const SystemSize& size, const FactorSize& factor) {
  const double solve = work_rates.factor_solve * 2.0 * 8.0 * factor.nonzeros / work_rates.core_speed;
  // Half a solve more than iterations: the stop test takes forward solves only, and the one for δ0 comes with the factorisation.
  return {work_rates.factor * factor.flops / work_rates.core_speed + 0.5 * solve, loop_work(size) + solve};
}

MethodWork direct_work(const FactorSize& factor) {
  return {work_rates.factor * factor.flops + work_rates.factor_solve * 2.0 * 8.0 * factor.nonzeros, 0.0};
}

}  // namespace taut
