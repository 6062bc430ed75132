// A matrix of one's own, solved with a core of one's own: the Laplacian of a square, ten times as
// stiff along x as along y, with the couplings along x in the core.
#include <taut/taut.h>

#include <cstdint>
#include <cstdio>
#include <vector>

int main() {
  const taut::Index side = 60, nodes = side * side;
  const auto node = [&](taut::Index i, taut::Index j) { return j * side + i; };
  std::vector<std::vector<taut::Index>> columns(nodes);
  for (taut::Index j = 0; j < side; ++j)
    for (taut::Index i = 0; i < side; ++i) {
      auto& row = columns[node(i, j)];
      if (j > 0) row.push_back(node(i, j - 1));
      if (i > 0) row.push_back(node(i - 1, j));
      row.push_back(node(i, j));
      if (i + 1 < side) row.push_back(node(i + 1, j));
      if (j + 1 < side) row.push_back(node(i, j + 1));
    }
  taut::BlockCsr a(taut::make_pattern(columns, 1));  // blocks of 1 x 1: a scalar matrix
  const taut::BlockPattern& p = *a.pattern;
  std::vector<std::uint8_t> core(p.blocks(), 0);
  for (taut::Index r = 0; r < nodes; ++r)
    for (taut::Index k = p.row_start[r]; k < p.row_start[r + 1]; ++k) {
      const taut::Index c = p.column[k];
      const bool along_x = c == r - 1 || c == r + 1;
      *a.block(r, k) = c == r ? 1.0 + 2 * 10.0 + 2 * 1.0 : along_x ? -10.0 : -1.0;
      core[k] = c == r || along_x;
    }

  const std::vector<double> b(nodes, 1.0);
  std::vector<double> x(nodes);
  taut::LinearSystem system;
  system.matrix = &a;
  system.rhs = b;
  system.core = {.name = "along x", .mask = core};
  for (const char* name : {"upcg:block_diagonal", "core_pcg:block", "block_cholesky"}) {
    const auto solver = taut::make_solver({.name = name, .tolerance = 1e-9});
    const taut::SolveSummary summary = solver->solve(system, x);
    if (!summary.status.ok()) return std::puts(summary.status.message.c_str()), 1;
    std::printf("%-20s %3d iterations, residual below 1e-8: %s, middle %.4f\n", name,
                summary.iterations, summary.relative_residual < 1e-8 ? "yes" : "no",
                x[node(side / 2, side / 2)]);
  }
}
