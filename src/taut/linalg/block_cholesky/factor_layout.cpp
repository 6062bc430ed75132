#include "taut/linalg/block_cholesky/factor_layout.h"

#include <algorithm>
#include <cassert>

namespace taut {

namespace {

class LayoutBuilder {
 public:
  LayoutBuilder(const SupernodeTree& tree, const CondensedGraph& graph,
                std::span<const Index> condensed_at, const KernelSizes& sizes)
      : tree_(tree),
        graph_(graph),
        condensed_at_(condensed_at),
        sizes_(sizes),
        condensed_(static_cast<Index>(graph.condensed.size())) {}

  FactorLayout build() {
    layout_.front.resize(static_cast<std::size_t>(tree_.supernodes()));
    layout_.condensed = condensed_;
    layout_.block_start.assign(1, 0);
    number_nodes();
    link_children();
    row_of_.assign(layout_.node.size(), -1);
    for (Index k = 0; k < condensed_; ++k) list_condensed_blocks(k);
    for (Index s = 0; s < tree_.supernodes(); ++s) {
      shape_front(s);
      place_blocks(s);
      take_condensed(s);
      for (Index c = layout_.front[s].child_begin; c < layout_.front[s].child_end; ++c)
        map_rows(layout_.child[c], layout_.front[s].shape.columns);
    }
    if (condensed_ > 0) pair_condensed();
    order_by_rows();
    return std::move(layout_);
  }

 private:
  void number_nodes() {
    const auto add = [&](const AnalyzedGraph& of, Index i) {
      layout_.node.push_back(of.node[i]);
      layout_.node_weight.push_back(of.weight[i]);
    };
    for (const Index i : graph_.condensed) add(graph_.all, i);
    for (const Index i : tree_.order) add(graph_.rest, i);
    layout_.place.assign(static_cast<std::size_t>(graph_.all.rows), -1);
    for (std::size_t k = 0; k < layout_.node.size(); ++k)
      layout_.place[layout_.node[k]] = static_cast<Index>(k);
    layout_.node_column.assign(layout_.node.size(), 0);
  }

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
    f.first_node = condensed_ + tree_.first[s], f.last_node = condensed_ + tree_.first[s + 1];
    for (Index k = f.first_node; k < f.last_node; ++k) f.pivots += weight_at(k);
    f.shape.slab_rows = sizes_.slab_rows;
    f.shape.columns =
        (f.pivots + sizes_.column_group - 1) / sizes_.column_group * sizes_.column_group;
    f.shape.padding = f.shape.columns - f.pivots;
    Index next = f.shape.padding;
    for (Index k = f.first_node; k < f.last_node; ++k) {
      row_of_[k] = layout_.node_column[k] = next;
      next += weight_at(k);
    }
    f.shape.rows = f.shape.columns;
    for (const Index row : tree_.rows(s)) {
      row_of_[condensed_ + row] = f.shape.rows;
      f.shape.rows += weight_at(condensed_ + row);
    }
    f.packed = layout_.packed_size;
    f.vector = layout_.vector_size;
    layout_.packed_size += sizes_.packed_size(f.shape);
    layout_.vector_size += f.shape.vector_size();
    const double n = f.shape.columns, m = f.shape.rows - f.shape.columns;
    layout_.flops += n * n * n / 3.0 + n * n * m + n * m * m;
  }

  void list_condensed_blocks(Index k) {
    const AnalyzedGraph& all = graph_.all;
    const Index i = graph_.condensed[k];
    layout_.gathered_start.push_back(layout_.gathered_size);
    const auto add = [&](Index place, Index value) {
      layout_.block.push_back({0, 0, place, 0});
      value_.push_back(value);
      layout_.gathered_size += 9;
    };
    add(k, all.diagonal[i]);
    for (Index e = all.graph.start[i]; e < all.graph.start[i + 1]; ++e)
      add(layout_.place[all.node[all.graph.neighbour[e]]], all.value[e]);
    layout_.block_start.push_back(static_cast<Index>(layout_.block.size()));
    const double neighbours = all.graph.start[i + 1] - all.graph.start[i];
    layout_.flops += 27.0 * neighbours * (neighbours + 1.0) / 2.0 + 18.0 * neighbours;
  }

  void place_blocks(Index s) {
    const AnalyzedGraph& rest = graph_.rest;
    for (Index k = layout_.front[s].first_node; k < layout_.front[s].last_node; ++k) {
      const Index i = tree_.order[k - condensed_];
      layout_.gathered_start.push_back(layout_.gathered_size);
      add_block(layout_.front[s].shape, k, k, rest.diagonal[i]);
      for (Index e = rest.graph.start[i]; e < rest.graph.start[i + 1]; ++e)
        if (const Index other = layout_.place[rest.node[rest.graph.neighbour[e]]]; other > k)
          add_block(layout_.front[s].shape, k, other, rest.value[e]);
      layout_.block_start.push_back(static_cast<Index>(layout_.block.size()));
    }
  }

  void order_by_rows() {
    layout_.row_start.push_back(0);
    for (const Index k : layout_.place) {
      layout_.row_to.push_back(k < 0 ? -1 : layout_.gathered_start[k]);
      if (k >= 0)
        layout_.row_value.insert(layout_.row_value.end(), &value_[layout_.block_start[k]],
                                 &value_[layout_.block_start[k]] +
                                     (layout_.block_start[k + 1] - layout_.block_start[k]));
      layout_.row_start.push_back(static_cast<Index>(layout_.row_value.size()));
    }
  }

  void take_condensed(Index s) {
    Front& f = layout_.front[s];
    f.first_condensed = s == 0 ? 0 : layout_.front[s - 1].last_condensed;
    f.last_condensed = f.first_condensed;
    while (f.last_condensed < condensed_ && condensed_at_[f.last_condensed] == s)
      ++f.last_condensed;
    for (Index e = layout_.block_start[f.first_condensed];
         e < layout_.block_start[f.last_condensed]; ++e)
      layout_.condensed_row.push_back(row_of_[layout_.block[e].place]);
  }

  // What condensed nodes leave to the others.
  void pair_condensed() {
    struct Planned {
      Index block;
      CondensedPair pair;
    };
    std::vector<Planned> planned;
    for (Index i = 0; i < condensed_; ++i) {
      const Index begin = layout_.block_start[i] + 1, end = layout_.block_start[i + 1];
      for (Index e = begin; e < end; ++e) {
        const Index j = layout_.block[e].place;
        for (Index f = begin; f < end; ++f)
          if (layout_.block[f].place >= j)
            planned.push_back({find_block(layout_, j, layout_.block[f].place), {e, f}});
      }
    }
    layout_.pair_start.assign(layout_.block.size() + 1, 0);
    std::ranges::stable_sort(planned, {}, &Planned::block);
    for (const Planned& p : planned) {
      ++layout_.pair_start[p.block + 1];
      layout_.pair.push_back(p.pair);
    }
    for (std::size_t e = 0; e < layout_.block.size(); ++e)
      layout_.pair_start[e + 1] += layout_.pair_start[e];
  }

  void add_block(const FrontShape& shape, Index node, Index place, Index value) {
    const Index row = row_of_[place], slab = row / sizes_.slab_rows,
                in_slab = row % sizes_.slab_rows;
    layout_.block.push_back({shape.panel_offset(slab) + in_slab, shape.panel_offset(slab + 1),
                             place, sizes_.slab_rows - in_slab});
    value_.push_back(value);
    layout_.gathered_size += Offset{weight_at(node)} * weight_at(place);
  }

  // How the rows of child c lie in its parent, whose rows row_of_ holds.
  void map_rows(Index c, Index parent_columns) {
    Front& child = layout_.front[c];
    child.run_begin = static_cast<Index>(layout_.run.size());
    child.spread_begin = static_cast<Index>(layout_.spread.size());
    child.run_split = child.spread_split = -1;
    Index from = child.shape.columns;
    for (const Index row : tree_.rows(c))
      for (Index k = condensed_ + row, to = row_of_[k]; to < row_of_[k] + weight_at(k);
           ++to, ++from) {
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
    const bool continues = static_cast<Index>(run.size()) > begin &&
                           run.back().to + run.back().count == to && to != parent_columns;
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
  const CondensedGraph& graph_;
  const std::span<const Index> condensed_at_;
  const KernelSizes sizes_;
  const Index condensed_;
  FactorLayout layout_;
  std::vector<Index> value_;   // per block: FactorLayout::row_value
  std::vector<Index> row_of_;  // by place in the order: first row in the front at hand
};

}  // namespace

FactorLayout make_factor_layout(const SupernodeTree& tree, const CondensedGraph& graph,
                                std::span<const Index> condensed_at, const KernelSizes& sizes) {
  return LayoutBuilder(tree, graph, condensed_at, sizes).build();
}

Index find_block(const FactorLayout& layout, Index place, Index other) {
  Index e = layout.block_start[place];
  while (e < layout.block_start[place + 1] && layout.block[e].place != other) ++e;
  assert(e < layout.block_start[place + 1] && "a block without a place");
  return e;
}

Offset FactorLayout::bytes() const {
  const auto size_of = [](const auto& v) { return static_cast<Offset>(v.size() * sizeof(v[0])); };
  return size_of(front) + size_of(child) + size_of(run) + size_of(spread) + size_of(node) +
         size_of(node_weight) + size_of(node_column) + size_of(place) + size_of(block_start) +
         size_of(block) + size_of(gathered_start) + size_of(row_start) + size_of(row_value) +
         size_of(row_to) + size_of(condensed_row) + size_of(pair_start) + size_of(pair) +
         size_of(task);
}

}  // namespace taut
