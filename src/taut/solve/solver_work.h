#pragma once
// What the methods cost, counted: the time of one solve on a machine with fixed rates, from the
// sizes of the system and of the factors. Only the ratios of the rates matter, and they are
// constants: the same choice on every machine, every run.
//
//   setup            factorisation or other preparation, and forming Ã where a method needs it
//   per_iteration    product, vector updates, preconditioner

#include "taut/solve/linear_system.h"

namespace taut {

// Taut's kernels relative to each other, seconds a byte and an operation; measured within steps on
// two cores of an x86-64 server (AVX-512), 6,561 and 25,921 nodes (`taut bench roofline --threads
// 2`).
struct WorkRates {
  double stream = 1.0 / 40e9;   // products and vectors: bytes read and written
  double reduce = 1.0 / 3.4e9;  // forming Ã: its bytes
  // IC(0)'s solves: bytes of the matrix it is made from; each row waits for the last
  double incomplete = 1.0 / 11e9;
  double incomplete_setup = 1.0 / 1.45e9;  // IC(0)'s factorisation: the same bytes
  // Cholesky factorisation, operations; in single precision half of it
  double factor = 1.0 / 120e9;
  // ... and its entries, likewise: small fronts are moved more than multiplied
  double factor_entry = 2.6e-9;
  // its two triangular solves: entries of the factor in single precision ...
  double factor_solve = 0.17e-9;
  double factor_node = 14e-9;  // ... and nodes
};
inline constexpr WorkRates work_rates{};

struct MethodWork {
  double setup = 0.0, per_iteration = 0.0;
  double total(double iterations) const { return setup + iterations * per_iteration; }
};

struct SystemSize {
  double unknowns = 0.0, nodes = 0.0;          // free ones; nodes: a third of them
  double nonzeros = 0.0, core_nonzeros = 0.0;  // of Ã and of its core, both triangles
  std::vector<double> other_core_nonzeros;     // 0 where it is not there
};
SystemSize size_of(const LinearSystem& system);

// nonzeros of the factor and operations, known from an analysis or else estimated.
struct FactorSize {
  double nonzeros = 0.0, flops = 0.0;
  double left_out = 0.0;  // nonzeros of Ã outside a core and its factor's fill
  bool known() const { return nonzeros > 0.0; }
};
// Nested dissection of a sheet whose matrix has this many nonzeros, fitted to the cores of grids
// with 4 to 12 neighbours a node: the more neighbours, the wider the separators.
FactorSize estimate_factor(const SystemSize& size, double nonzeros);

MethodWork block_diagonal_work(const SystemSize& size);
// preparations: how often IC(0) was factorised.
MethodWork incomplete_work(const SystemSize& size, double nonzeros, double preparations);
// preparations: 1, or 2 where the factor had to be computed again in double precision.
MethodWork core_work(const SystemSize& size, const FactorSize& factor, double preparations = 1.0);
MethodWork direct_work(const FactorSize& factor);  // its one solve is in setup

}  // namespace taut
