#pragma once
// What the methods cost, counted: the time of one solve on a machine with fixed rates, from the sizes of the system and of the factors.
// Only the ratios of the rates matter, and they are constants: the same choice on every machine, every run.
//
//   setup            factorisation or other preparation; what all methods do alike (forming Ã) is left out
//   per_iteration    product, vector updates, preconditioner

#include "taut/solve/linear_system.h"

namespace taut {

// Taut's kernels relative to each other, seconds a byte and an operation; measured on two cores of an x86-64 server (AVX2), 6,561 and
// 25,921 nodes (`taut bench roofline --threads 2`).
struct WorkRates {
  double stream = 1.0 / 20e9;             // products and vectors: bytes read and written
  double incomplete = 1.0 / 8e9;          // IC(0)'s solves: bytes of the matrix it is made from; each row waits for the last
  double incomplete_setup = 1.0 / 0.7e9;  // IC(0)'s factorisation: the same bytes
  double factor = 1.0 / 28e9;             // Cholesky factorisation, operations
  double factor_solve = 1.0 / 16e9;       // its triangular solves: bytes of the factor
  double core_speed = 1.8;                // of the core's factor, in single precision, against the direct method's
};
inline constexpr WorkRates work_rates{};

struct MethodWork {
  double setup = 0.0, per_iteration = 0.0;
  double total(double iterations) const { return setup + iterations * per_iteration; }
};

struct SystemSize {
  double unknowns = 0.0, nodes = 0.0;          // free ones; nodes: a third of them
  double nonzeros = 0.0, core_nonzeros = 0.0;  // of Ã and of its core, both triangles
  double stretch_core_nonzeros = 0.0;          // of the paper's core where that is another, else 0
};
SystemSize size_of(const LinearSystem& system);

// nonzeros of the factor and operations, known from an analysis or else estimated.
struct FactorSize {
  double nonzeros = 0.0, flops = 0.0;
  bool known() const { return nonzeros > 0.0; }
};
// Nested dissection of a sheet whose matrix has this many nonzeros, fitted to grids with and without bend springs: separators of twice the
// width where springs reach over two nodes.
FactorSize estimate_factor(const SystemSize& size, double nonzeros);

MethodWork block_diagonal_work(const SystemSize& size);
// preparations: how often IC(0) was factorised.
MethodWork incomplete_work(const SystemSize& size, double nonzeros, double preparations);
MethodWork core_work(const SystemSize& size, const FactorSize& factor);
MethodWork direct_work(const FactorSize& factor);  // its one solve is in setup

}  // namespace taut
