#include "taut/linalg/block_cholesky.h"

#include <cassert>

#include "taut/linalg/block_cholesky/numeric_factor.h"

namespace taut {

struct BlockCholesky::Implementation {
  CholeskyPrecision precision;
  AnalyzedGraph graph;
  SupernodeTree tree;
  std::unique_ptr<NumericFactor<float>> single_factor;
  std::unique_ptr<NumericFactor<double>> double_factor;
  bool single = false;  // which of them holds the factor
  int fallbacks = 0;

  // Of the matrix last factorised:
  std::shared_ptr<const BlockPattern> pattern;
  std::vector<Index> start;           // per place in the order: first unknown in A's numbering ...
  std::vector<Index> permuted_start;  // ... and in the factor's
  std::vector<Index> permutation;

  void number_unknowns(const BlockPattern& p) {
    start.resize(tree.order.size());
    permuted_start.resize(tree.order.size());
    permutation.clear();
    for (std::size_t k = 0; k < start.size(); ++k) {
      const Index node = graph.node[tree.order[k]];
      start[k] = p.dof_start[node];
      permuted_start[k] = static_cast<Index>(permutation.size());
      for (Index r = 0; r < p.dim(node); ++r) permutation.push_back(start[k] + r);
    }
  }

  // Either factor, as f(factor).
  template <class Function>
  auto with_factor(Function f) {
    return single ? f(*single_factor) : f(*double_factor);
  }

  Status factorize_in(bool in_single, const BlockCsr& a) {
    single = in_single;
    if (single && !single_factor) single_factor = std::make_unique<NumericFactor<float>>(tree, graph);
    if (!single && !double_factor) double_factor = std::make_unique<NumericFactor<double>>(tree, graph);
    return with_factor([&](auto& factor) { return factor.factorize(a); });
  }
};

BlockCholesky::BlockCholesky(CholeskyPrecision precision) : implementation_(std::make_unique<Implementation>()) {
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

Status BlockCholesky::analyze(const BlockCsr& a) {
  const Status status = analyze(*a.pattern);
  implementation_->pattern = a.pattern;
  return status;
}

Status BlockCholesky::analyze(const BlockPattern& pattern) {
  Implementation& me = *implementation_;
  me.pattern = nullptr;
  me.single_factor = nullptr;
  me.double_factor = nullptr;
  try {
    me.graph = analyzed_graph(pattern);
    me.tree = make_supernode_tree(me.graph.graph, nested_dissection(me.graph.graph), me.graph.weight);
    me.single = me.precision != CholeskyPrecision::double_precision;
    if (me.single) {
      me.single_factor = std::make_unique<NumericFactor<float>>(me.tree, me.graph);
    } else {
      me.double_factor = std::make_unique<NumericFactor<double>>(me.tree, me.graph);
    }
  } catch (const std::bad_alloc&) {
    return {Outcome::out_of_memory, "Cholesky (block), analysis: not enough memory"};
  }
  me.number_unknowns(pattern);
  return {};
}

Status BlockCholesky::factorize(const BlockCsr& a) {
  Implementation& me = *implementation_;
  assert(me.single_factor || me.double_factor);
  if (me.pattern != a.pattern) {
    if (const std::string mismatch = me.graph.mismatch(*a.pattern); !mismatch.empty())
      return {Outcome::breakdown, "Cholesky (block): the matrix does not fit the analysed pattern: " + mismatch};
    me.number_unknowns(*a.pattern);
    me.pattern = a.pattern;
  }
  try {
    Status status = me.factorize_in(me.precision != CholeskyPrecision::double_precision, a);
    if (status.ok() || me.precision != CholeskyPrecision::automatic) return status;
    ++me.fallbacks;
    return me.factorize_in(false, a);
  } catch (const std::bad_alloc&) {
    return {Outcome::out_of_memory, "Cholesky (block), factorisation: not enough memory"};
  }
}

Status BlockCholesky::solve(std::span<const double> b, std::span<double> x) {
  implementation_->with_factor([&](auto& factor) { factor.solve(implementation_->start, b, x); });
  return {};
}

std::span<const Index> BlockCholesky::permutation() const { return implementation_->permutation; }

Status BlockCholesky::solve_permuted(std::span<const double> b, std::span<double> x) {
  implementation_->with_factor([&](auto& factor) { factor.solve(implementation_->permuted_start, b, x); });
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
  s.factor_entries = me.tree.factor_entries;
  s.flops = me.tree.factor_flops;
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
