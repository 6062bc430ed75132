#include "taut/linalg/block_cholesky/factor_layout.h"

#include "taut/linalg/block_cholesky/elimination_tree.h"

namespace taut {

namespace {

class LayoutBuilder {
 public:
  LayoutBuilder(const SupernodeTree& tree, const AnalyzedGraph& analyzed, Index slab_rows, Index column_group,
                Offset (*packed_size)(const FrontShape&))
      : tree_(tree), analyzed_(analyzed), slab_rows_(slab_rows), column_group_(column_group), packed_size_(packed_size) {}

  FactorLayout build() {
    layout_.front.resize(static_cast<std::size_t>(tree_.supernodes()));
    layout_.node_column.resize(tree_.order.size());
    layout_.block_start.assign(1, 0);
    for (const Index i : tree_.order) {
      layout_.node.push_back(analyzed_.node[i]);
      layout_.node_weight.push_back(analyzed_.weight[i]);
      layout_.node_width.push_back(analyzed_.width[i]);
    }
    link_children();
    place_ = inverse_permutation(tree_.order);
    row_of_.assign(tree_.order.size(), -1);
    for (Index s = 0; s < tree_.supernodes(); ++s) {
      shape_front(s);
      place_blocks(s);
      for (Index c = layout_.front[s].child_begin; c < layout_.front[s].child_end; ++c)
        cut_pieces(s, layout_.front[layout_.child[c]], layout_.child[c]);
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
    f.shape.slab_rows = slab_rows_;
    f.shape.columns = (f.pivots + column_group_ - 1) / column_group_ * column_group_;
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
    layout_.packed_size += packed_size_(f.shape);
    layout_.vector_size += f.shape.vector_size();
    const double n = f.shape.columns, m = f.shape.rows - f.shape.columns;
    layout_.flops += n * n * n / 3.0 + n * n * m + n * m * m;
  }

  void place_blocks(Index s) {
    for (Index k = layout_.front[s].first_node; k < layout_.front[s].last_node; ++k) {
      const NodeGraph& graph = analyzed_.graph;
      const Index i = tree_.order[k];
      add_block(layout_.front[s].shape, k, analyzed_.diagonal[i]);
      for (Index e = graph.start[i]; e < graph.start[i + 1]; ++e)
        if (const Index other = place_[graph.neighbour[e]]; other > k) add_block(layout_.front[s].shape, other, analyzed_.value[e]);
      layout_.block_start.push_back(static_cast<Index>(layout_.block.size()));
    }
  }

  void add_block(const FrontShape& shape, Index place, Offset value) {
    const Index row = row_of_[place], in_slab = row % slab_rows_;
    layout_.block.push_back({place, value, row, slab_rows_ - in_slab, shape.panel_offset(row / slab_rows_) + in_slab});
  }

  // How the rows of child c lie in its parent s: runs, cut at the borders of slabs and at the end of the parent's pivots.
  void cut_pieces(Index s, Front& child, Index c) {
    const Front& parent = layout_.front[s];
    child.piece_begin = child.piece_split = static_cast<Index>(layout_.piece.size());
    Index from = child.shape.columns;
    for (const Index k : tree_.rows(c)) {
      for (Index r = 0; r < weight_at(k); ++r, ++from) append_row(from, row_of_[k] + r, child.piece_begin, parent.shape.columns);
      if (row_of_[k] < parent.shape.columns) child.piece_split = static_cast<Index>(layout_.piece.size());
    }
    child.piece_end = static_cast<Index>(layout_.piece.size());
  }

  void append_row(Index from, Index to, Index piece_begin, Index parent_columns) {
    auto& piece = layout_.piece;
    const bool may_continue =
        static_cast<Index>(piece.size()) > piece_begin && from % slab_rows_ != 0 && to % slab_rows_ != 0 && to != parent_columns;
    if (may_continue && piece.back().to + piece.back().count == to) {
      ++piece.back().count;
    } else {
      piece.push_back({from, to, 1});
    }
  }

  const SupernodeTree& tree_;
  const AnalyzedGraph& analyzed_;
  const Index slab_rows_, column_group_;
  Offset (*const packed_size_)(const FrontShape&);
  FactorLayout layout_;
  std::vector<Index> place_;   // of each node in the order
  std::vector<Index> row_of_;  // by place in the order: first row in the front at hand
};

}  // namespace

FactorLayout make_factor_layout(const SupernodeTree& tree, const AnalyzedGraph& analyzed, Index slab_rows, Index column_group,
                                Offset (*packed_size)(const FrontShape&)) {
  return LayoutBuilder(tree, analyzed, slab_rows, column_group, packed_size).build();
}

Offset FactorLayout::bytes() const {
  const auto size_of = [](const auto& v) { return static_cast<Offset>(v.size() * sizeof(v[0])); };
  return size_of(front) + size_of(child) + size_of(piece) + size_of(node) + size_of(node_weight) + size_of(node_width) +
         size_of(node_column) + size_of(block_start) + size_of(block) + size_of(task);
}

}  // namespace taut
