#include "taut/linalg/block_cholesky.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "taut/linalg/block_cholesky/covered_blocks.h"
#include "taut/linalg/block_cholesky/elimination_order.h"
#include "taut/linalg/block_cholesky/numeric_factor.h"
#include "taut/linalg/vector_ops.h"

namespace taut {

struct BlockCholesky::Implementation {
  CholeskyPrecision precision;
  CondensedGraph graph;
  SupernodeTree tree;               // of the nodes that are not condensed
  std::vector<Index> condensed_at;  // the supernode of each condensed one
  std::unique_ptr<NumericFactor<float>> single_factor;
  std::unique_ptr<NumericFactor<double>> double_factor;
  bool single = false;  // which of them holds the factor
  int fallbacks = 0;

  std::shared_ptr<const BlockPattern> analyzed;  // null if the analysis was given no owner
  std::vector<std::uint8_t> analyzed_blocks;     // of that pattern
  UnanalyzedBlocks unanalyzed;                   // the others
  std::vector<Parallelogram> parallelograms;     // that can stand in for some of them
  // Of the matrix last factorised:
  std::shared_ptr<const BlockPattern> pattern;
  double scale = 1.0;                 // of the last forward solve
  std::vector<Index> start;           // per place in the order: first unknown in A's numbering ...
  std::vector<Index> permuted_start;  // ... and in the factor's
  std::vector<Index> permutation;

  void number_unknowns(const BlockPattern& p) {
    start.clear();
    permuted_start.clear();
    permutation.clear();
    const auto add = [&](Index node) {
      start.push_back(p.dof_start[node]);
      permuted_start.push_back(static_cast<Index>(permutation.size()));
      for (Index r = 0; r < p.dim(node); ++r) permutation.push_back(p.dof_start[node] + r);
    };
    for (const Index i : graph.condensed) add(graph.all.node[i]);
    for (const Index i : tree.order) add(graph.rest.node[i]);
  }

  // Either factor, as f(factor).
  template <class Function>
  auto with_factor(Function f) {
    return single ? f(*single_factor) : f(*double_factor);
  }

  void make_factor(bool in_single) {
    single = in_single;
    if (single && !single_factor)
      single_factor = std::make_unique<NumericFactor<float>>(tree, graph, condensed_at);
    if (!single && !double_factor)
      double_factor = std::make_unique<NumericFactor<double>>(tree, graph, condensed_at);
  }

  // Single precision sees vectors whose largest entry is about 1: what is left of a residual may be
  // far below its range.
  double scale_for(std::span<const double> b) const {
    return single ? scale_for(largest_magnitude(b)) : 1.0;
  }
  double scale_for(double largest) const {
    return single && largest > 0.0 && std::isfinite(largest)
               ? std::ldexp(1.0, -std::clamp(std::ilogb(largest), -1000, 1000))
               : 1.0;
  }
  double forward_norm2() {
    return with_factor([&](auto& factor) { return factor.forward_norm2(); }) / (scale * scale);
  }

  // A right-hand side that is solved on the way, and where bᵀ A⁻¹ b goes.
  struct Load {
    std::span<const double> b;
    double* norm2;
  };

  Status factorize_in(bool in_single, const FactorSource& source, std::span<const Load> loads) {
    make_factor(in_single);
    std::array<FactorLoad, 2> list;
    for (std::size_t k = 0; k < loads.size(); ++k)
      list[k] = {loads[k].b.data(), scale_for(loads[k].b)};
    const Status status = with_factor([&](auto& factor) {
      return factor.factorize(source, start, std::span(list).first(loads.size()));
    });
    if (loads.empty() || !status.ok()) return status;
    scale = list[loads.size() - 1].scale;
    if (loads.back().norm2) *loads.back().norm2 = forward_norm2();
    if (loads.size() > 1)
      *loads[0].norm2 = with_factor([&](auto& factor) { return factor.first_load_norm2(); }) /
                        (list[0].scale * list[0].scale);
    return status;
  }

  Status factorize(const FactorSource& source, std::span<const Load> loads) {
    try {
      Status status = factorize_in(precision != CholeskyPrecision::double_precision, source, loads);
      if (status.ok() || precision != CholeskyPrecision::automatic) return status;
      ++fallbacks;
      FactorSource again = source;
      again.visit = nullptr, again.beside = nullptr;
      return factorize_in(false, again, loads);
    } catch (const std::bad_alloc&) {
      return {Outcome::out_of_memory, "Cholesky (block), factorisation: not enough memory"};
    }
  }

  Status factorize_with_basis(const BlockCsr& a, const NodeBasis& basis,
                              std::span<const Load> loads, const BlocksOutside& outside) {
    assert(a.pattern == analyzed);
    assert(basis.dim.empty() ||
           (a.pattern->uniform_dim == 3 && static_cast<Index>(basis.dim.size()) == a.rows()));
    if (pattern != a.pattern) number_unknowns(*a.pattern);
    pattern = a.pattern;
    assert(!outside.lumped || a.pattern->uniform_dim == 3);
    assert(outside.lumped || !outside.replaced);
    FactorSource source{a, basis, true};
    if (outside.lumped) source.lumped = &unanalyzed;
    if (outside.replaced) source.replaced = parallelograms;
    if (outside.visit) source.visit = &outside.visit;
    source.beside = &outside.beside;
    return factorize(source, loads);
  }

  void take_blocks(const BlockPattern& p, std::span<const std::uint8_t> mask,
                   BlocksLeftOut left_out) {
    if (left_out == BlocksLeftOut::without_place) {
      analyzed_blocks = covered_blocks(p, mask, graph, tree);
      graph = condensed_graph(analyzed_graph(p, analyzed_blocks), std::move(graph.condensed));
      return;
    }
    analyzed_blocks.assign(mask.begin(), mask.end());
    analyzed_blocks.resize(static_cast<std::size_t>(p.blocks()), 1);
    for (const Index k : p.diagonal) analyzed_blocks[k] = 1;
  }

  Status analyze(const BlockPattern& p, std::span<const std::uint8_t> mask,
                 BlocksLeftOut left_out) {
    pattern = nullptr;
    analyzed = nullptr;
    single_factor = nullptr;
    double_factor = nullptr;
    try {
      AnalyzedGraph all = analyzed_graph(p, mask);
      std::vector<Index> condensed = condensed_nodes(all);
      graph = condensed_graph(std::move(all), std::move(condensed));
      tree = make_supernode_tree(graph.rest.graph,
                                 elimination_order(graph.rest.graph, graph.rest.weight),
                                 graph.rest.weight);
      take_blocks(p, mask, left_out);
      condensed_at = assign_condensed(graph, tree);
      parallelograms.clear();
      if (!mask.empty() && p.uniform_dim == 3)
        parallelograms = taut::parallelograms(p, mask, analyzed_blocks);
      unanalyzed = unanalyzed_blocks(p, analyzed_blocks, parallelograms);
      make_factor(precision != CholeskyPrecision::double_precision);
    } catch (const std::bad_alloc&) {
      return {Outcome::out_of_memory, "Cholesky (block), analysis: not enough memory"};
    }
    number_unknowns(p);
    return {};
  }

  void solve(std::span<const Index> numbering, std::span<const double> b, std::span<double> x) {
    with_factor([&](auto& factor) {
      factor.solve_forward({numbering}, b.data());
      factor.solve_backward({numbering}, 0.0, x.data());
    });
  }
};

BlockCholesky::BlockCholesky(CholeskyPrecision precision)
    : implementation_(std::make_unique<Implementation>()) {
  implementation_->precision = precision;
  implementation_->single = precision != CholeskyPrecision::double_precision;
}

BlockCholesky::~BlockCholesky() = default;

std::string BlockCholesky::name() const {
  switch (implementation_->precision) {
    case CholeskyPrecision::single_precision:
      return "block_single";
    case CholeskyPrecision::automatic:
      return "block_automatic";
    default:
      return "block";
  }
}

void BlockCholesky::set_precision(CholeskyPrecision precision) {
  implementation_->precision = precision;
}

Status BlockCholesky::analyze(const BlockCsr& a) { return analyze(a.pattern, {}); }

Status BlockCholesky::analyze(const BlockPattern& pattern) {
  return implementation_->analyze(pattern, {}, BlocksLeftOut::all_outside_mask);
}

Status BlockCholesky::analyze(std::shared_ptr<const BlockPattern> pattern,
                              std::span<const std::uint8_t> mask, BlocksLeftOut left_out) {
  const Status status = implementation_->analyze(*pattern, mask, left_out);
  implementation_->pattern = implementation_->analyzed = std::move(pattern);
  return status;
}

std::span<const std::uint8_t> BlockCholesky::analyzed_blocks() const {
  return implementation_->analyzed_blocks;
}

std::span<const Parallelogram> BlockCholesky::parallelograms() const {
  return implementation_->parallelograms;
}

Status BlockCholesky::factorize(const BlockCsr& a) {
  Implementation& me = *implementation_;
  assert(me.single_factor || me.double_factor);
  if (me.pattern != a.pattern) {
    if (const std::string mismatch = me.graph.all.mismatch(*a.pattern); !mismatch.empty())
      return {Outcome::breakdown,
              "Cholesky (block): the matrix does not fit the analysed pattern: " + mismatch};
    me.number_unknowns(*a.pattern);
    me.pattern = a.pattern;
  }
  return me.factorize({a, {}, a.pattern == me.analyzed}, {});
}

Status BlockCholesky::factorize(const BlockCsr& a, const NodeBasis& basis,
                                std::span<const double> b, double* b_norm2,
                                const BlocksOutside& outside) {
  const Implementation::Load load{b, b_norm2};
  return implementation_->factorize_with_basis(a, basis, {&load, b.empty() ? 0u : 1u}, outside);
}

Status BlockCholesky::factorize(const BlockCsr& a, const NodeBasis& basis,
                                std::span<const double> b, double& b_norm2,
                                std::span<const double> r, double& r_norm2,
                                const BlocksOutside& outside) {
  const Implementation::Load loads[] = {{b, &b_norm2}, {r, &r_norm2}};
  return implementation_->factorize_with_basis(a, basis, loads, outside);
}

double BlockCholesky::solve_forward(std::span<const double> b) {
  return solve_forward(b, implementation_->single ? largest_magnitude(b) : 0.0);
}

double BlockCholesky::solve_forward(std::span<const double> b, double largest) {
  Implementation& me = *implementation_;
  me.scale = me.scale_for(largest);
  me.with_factor([&](auto& factor) { factor.solve_forward({me.start, me.scale}, b.data()); });
  return me.forward_norm2();
}

void BlockCholesky::solve_backward(double beta, std::span<double> x) {
  Implementation& me = *implementation_;
  me.with_factor(
      [&](auto& factor) { factor.solve_backward({me.start, me.scale}, beta, x.data()); });
}

Status BlockCholesky::solve(std::span<const double> b, std::span<double> x) {
  implementation_->solve(implementation_->start, b, x);
  return {};
}

std::span<const Index> BlockCholesky::permutation() const { return implementation_->permutation; }

Status BlockCholesky::solve_permuted(std::span<const double> b, std::span<double> x) {
  implementation_->solve(implementation_->permuted_start, b, x);
  return {};
}

FactorStatistics BlockCholesky::statistics() const {
  const BlockCholeskyStatistics s = block_statistics();
  return {s.factor_entries, s.flops, s.total_bytes, "metis"};
}

BlockCholeskyStatistics BlockCholesky::block_statistics() const {
  Implementation& me = *implementation_;
  if (!me.single_factor && !me.double_factor) return {};
  BlockCholeskyStatistics s;
  s.supernodes = me.tree.supernodes();
  s.condensed = static_cast<Index>(me.graph.condensed.size());
  s.factor_entries = me.tree.factor_entries;
  s.flops = me.tree.factor_flops;
  for (const Index i : me.graph.condensed) {
    const double below = 3.0 * (me.graph.all.graph.start[i + 1] - me.graph.all.graph.start[i]);
    s.factor_entries += 6.0 + 3.0 * below;
    for (const double own : {1.0, 2.0, 3.0}) s.flops += (below + own) * (below + own);
  }
  s.single_precision = me.single;
  s.fallbacks = me.fallbacks;
  me.with_factor([&](const auto& factor) {
    s.padded_flops = factor.layout().flops;
    s.panel_bytes = static_cast<double>(factor.panel_bytes());
    s.total_bytes = static_cast<double>(factor.bytes());
    s.instruction_set = factor.instruction_set();
  });
  return s;
}

}  // namespace taut
