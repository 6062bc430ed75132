#include "taut/linalg/block_cholesky/factor_layout.h"

#include <algorithm>

#include "taut/linalg/block_cholesky/elimination_tree.h"

namespace taut {

namespace {

class LayoutBuilder {
 public:
  LayoutBuilder(const SupernodeTree& tree, const AnalyzedGraph& analyzed, const KernelSizes& sizes)
      : tree_(tree), analyzed_(analyzed), sizes_(sizes) {}

  FactorLayout build() {
    layout_.front.resize(static_cast<std::size_t>(tree_.supernodes()));
    layout_.node_column.resize(tree_.order.size());
    layout_.block_start.assign(1, 0);
    for (const Index i : tree_.order) {
      layout_.node.push_back(analyzed_.node[i]);
      layout_.node_weight.push_back(analyzed_.weight[i]);
    }
    link_children();
    place_ = inverse_permutation(tree_.order);
    layout_.place.assign(static_cast<std::size_t>(analyzed_.rows), -1);
    for (std::size_t k = 0; k < layout_.node.size(); ++k) layout_.place[layout_.node[k]] = static_cast<Index>(k);
    row_of_.assign(tree_.order.size(), -1);
    for (Index s = 0; s < tree_.supernodes(); ++s) {
      shape_front(s);
      place_blocks(s);
      for (Index c = layout_.front[s].child_begin; c < layout_.front[s].child_end; ++c)
        map_rows(layout_.child[c], layout_.front[s].shape.columns);
    }
    return std::move(layout_);
  }

 private:
  void link_children() {
    const Index n = tree_.supernodes();
    std::vector<Index> next(static_cast<std::size_t>(n) + 1, 0);
    for (Index s = 0; s < n; ++s)
      if (tree_.parent[s] >= 0) ++next[tree_.parent[s] + 1];
    for (Index s = 0; s < n; ++s) {
      next[s + 1] += next[s];
      layout_.front[s].child_begin = next[s], layout_.front[s].child_end = next[s + 1];
    }
    layout_.child.resize(static_cast<std::size_t>(next[n]));
    for (Index s = 0; s < n; ++s)
      if (const Index p = tree_.parent[s]; p >= 0) layout_.child[next[p]++] = s;
  }

  Index weight_at(Index place) const { return layout_.node_weight[place]; }

  // Sizes, offsets, and row_of_ for the nodes of this front.
  void shape_front(Index s) {
    Front& f = layout_.front[s];
    f.parent = tree_.parent[s];
    f.first_node = tree_.first[s], f.last_node = tree_.first[s + 1];
    for (Index k = f.first_node; k < f.last_node; ++k) f.pivots += weight_at(k);
    f.shape.slab_rows = sizes_.slab_rows;
    f.shape.columns = (f.pivots + sizes_.column_group - 1) / sizes_.column_group * sizes_.column_group;
    f.shape.padding = f.shape.columns - f.pivots;
    Index next = f.shape.padding;
    for (Index k = f.first_node; k < f.last_node; ++k) {
      row_of_[k] = layout_.node_column[k] = next;
      next += weight_at(k);
    }
    f.shape.rows = f.shape.columns;
    for (const Index k : tree_.rows(s)) {
      row_of_[k] = f.shape.rows;
      f.shape.rows += weight_at(k);
    }
    f.packed = layout_.packed_size;
    f.vector = layout_.vector_size;
    layout_.packed_size += sizes_.packed_size(f.shape);
    layout_.vector_size += f.shape.vector_size();
    const double n = f.shape.columns, m = f.shape.rows - f.shape.columns;
    layout_.flops += n * n * n / 3.0 + n * n * m + n * m * m;
  }

  void place_blocks(Index s) {
    for (Index k = layout_.front[s].first_node; k < layout_.front[s].last_node; ++k) {
      const NodeGraph& graph = analyzed_.graph;
      const Index i = tree_.order[k];
      layout_.gathered_start.push_back(layout_.gathered_size);
      add_block(layout_.front[s].shape, k, k, analyzed_.diagonal[i]);
      for (Index e = graph.start[i]; e < graph.start[i + 1]; ++e)
        if (const Index other = place_[graph.neighbour[e]]; other > k) add_block(layout_.front[s].shape, k, other, analyzed_.value[e]);
      layout_.block_start.push_back(static_cast<Index>(layout_.block.size()));
    }
  }

  void add_block(const FrontShape& shape, Index node, Index place, Index value) {
    const Index row = row_of_[place], slab = row / sizes_.slab_rows, in_slab = row % sizes_.slab_rows;
    layout_.block.push_back({shape.panel_offset(slab) + in_slab, shape.panel_offset(slab + 1), place, sizes_.slab_rows - in_slab});
    layout_.block_value.push_back(value);
    layout_.gathered_size += Offset{weight_at(node)} * weight_at(place);
  }

  // How the rows of child c lie in its parent, whose rows row_of_ holds.
  void map_rows(Index c, Index parent_columns) {
    Front& child = layout_.front[c];
    child.run_begin = static_cast<Index>(layout_.run.size());
    child.spread_begin = static_cast<Index>(layout_.spread.size());
    child.run_split = child.spread_split = -1;
    Index from = child.shape.columns;
    for (const Index k : tree_.rows(c))
      for (Index to = row_of_[k]; to < row_of_[k] + weight_at(k); ++to, ++from) {
        append_to_runs(from, to, child.run_begin, parent_columns);
        append_to_spreads(from, to, child.spread_begin);
        if (to < parent_columns || child.run_split >= 0) continue;
        child.run_split = static_cast<Index>(layout_.run.size()) - 1;
        child.spread_split = static_cast<Index>(layout_.spread.size()) - 1;
      }
    child.run_end = static_cast<Index>(layout_.run.size());
    child.spread_end = static_cast<Index>(layout_.spread.size());
    if (child.run_split < 0) child.run_split = child.run_end, child.spread_split = child.spread_end;
  }

  void append_to_runs(Index from, Index to, Index begin, Index parent_columns) {
    auto& run = layout_.run;
    const bool continues = static_cast<Index>(run.size()) > begin && run.back().to + run.back().count == to && to != parent_columns;
    if (continues) {
      ++run.back().count;
    } else {
      run.push_back({from, to, 1});
    }
  }

  void append_to_spreads(Index from, Index to, Index begin) {
    auto& spread = layout_.spread;
    const Index lanes = sizes_.lanes, register_begin = to / lanes * lanes;
    if (static_cast<Index>(spread.size()) == begin || spread.back().to != register_begin) {
      spread.push_back({from / lanes * lanes, register_begin, from, {}});
      std::ranges::fill(spread.back().lane, std::int8_t{-1});
    }
    spread.back().lane[to - register_begin] = static_cast<std::int8_t>(from - spread.back().from);
    spread.back().last = from;
  }

  const SupernodeTree& tree_;
  const AnalyzedGraph& analyzed_;
  const KernelSizes sizes_;
  FactorLayout layout_;
  std::vector<Index> place_;   // of each node in the order
  std::vector<Index> row_of_;  // by place in the order: first row in the front at hand
};

}  // namespace

FactorLayout make_factor_layout(const SupernodeTree& tree, const AnalyzedGraph& analyzed, const KernelSizes& sizes) {
  return LayoutBuilder(tree, analyzed, sizes).build();
}

Offset FactorLayout::bytes() const {
  const auto size_of = [](const auto& v) { return static_cast<Offset>(v.size() * sizeof(v[0])); };
  return size_of(front) + size_of(child) + size_of(run) + size_of(spread) + size_of(node) + size_of(node_weight) + size_of(node_column) +
         size_of(place) + size_of(block_start) + size_of(block) + size_of(block_value) + size_of(gathered_start) + size_of(task);
}

}  // namespace taut
