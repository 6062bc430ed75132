#pragma once
// Where everything of a factorisation lies in memory, planned once per analysis: panels, updates,
// vectors, and how children enter their parents (docs/design/block-cholesky.md). A supernode is a
// front; its rows are padding and its pivots, then the unknowns of its row nodes, in the order of
// elimination. Condensed nodes come first in that order.
//
//   gathered   A's blocks in the order of elimination; of condensed nodes their G and U
//   scratch    of each thread, for the task at hand: panels and updates while they are needed
//   arena      the same of fronts that are tasks of their own, and the updates that tasks hand on
//   packed     panels in the order of elimination: the factor L, which the solves stream through
//   vector     vector_size() entries a front: what the solves work on
//
// Tasks are whole subtrees, each eliminated by one thread in order, and single fronts above them.
// The plan depends on `threads`; the numbers that come out do not.

#include <span>
#include <vector>

#include "taut/base/task_tree.h"
#include "taut/linalg/block_cholesky/condensation.h"
#include "taut/linalg/block_cholesky/front_kernels.h"
#include "taut/linalg/block_cholesky/supernodes.h"

namespace taut {

struct Front {
  FrontShape shape;
  Index parent = -1;
  Index pivots = 0;                     // unknowns, without padding
  Index first_node = 0, last_node = 0;  // places of its pivot nodes in the order
  // places of the condensed nodes that the solves take in here
  Index first_condensed = 0, last_condensed = 0;
  Index child_begin = 0, child_end = 0;  // into FactorLayout::child
  // Into FactorLayout::run and ::spread: how its rows below the pivots lie in its parent. Runs
  // before the split are pivots there, spreads before theirs hold nothing else.
  Index run_begin = 0, run_split = 0, run_end = 0;
  Index spread_begin = 0, spread_split = 0, spread_end = 0;
  Offset panel = 0, update = 0;
  bool panel_in_scratch = false, update_in_scratch = false;  // else in the arena
  Offset packed = 0, vector = 0;
};

// A block of A below or on the diagonal, in the column of a pivot node.
struct BlockPlace {
  Offset offset = 0;     // of the other node's first row in the panel's first column
  Offset next_slab = 0;  // of the first row of the slab after it there
  Index place = 0;       // of the other node in the order
  // how many of the other node's rows are in the slab where it begins, or more
  Index rows_in_slab = 0;
};

// Fronts begin ... end-1; `shared`: a single one, large enough for several threads.
struct FrontTask {
  Index begin = 0, end = 0;
  bool shared = false;
};

// Blocks U_ij and U_ik, whose product enters the block of j and k.
struct CondensedPair {
  Index first, second;
};

struct FactorLayout {
  Index condensed = 0;  // so many nodes at the begin of the order
  std::vector<Front> front;
  std::vector<Index> child;  // ascending for each front: the order in which updates are added
  std::vector<RowRun> run;
  std::vector<RowSpread> spread;
  std::vector<Index> node;         // per place in the order: the node of A
  std::vector<Index> node_weight;  // per place in the order: its unknowns
  std::vector<Index> node_column;  // per place in the order: first column of the node in its front
  std::vector<Index> place;        // per row of A: of its node in the order, or -1
  std::vector<Index> block_start;  // per place in the order, into block and block_value; nodes + 1
  std::vector<BlockPlace> block;   // the node's diagonal block first, then those of later nodes
  // per place in the order: where its blocks begin among those gathered from A
  std::vector<Offset> gathered_start;
  // In the order of A's rows, as gathering goes:
  // per row, into row_value: its node's blocks, in the order of `block`; rows + 1
  std::vector<Index> row_start;
  // per block: its first column in the row of the analysed matrix; -1: it has none there
  std::vector<Index> row_value;
  std::vector<Offset> row_to;  // per row: gathered_start of its node; -1 without unknowns
  // Where nodes are condensed, and then a gathered block e begins at 9 e: per block of condensed
  // nodes: where the other node begins in the vector of the front that takes it in
  std::vector<Index> condensed_row;
  std::vector<Index> pair_start;    // per block, into pair; blocks + 1
  std::vector<CondensedPair> pair;  // first: at the node that has the block
  std::vector<FrontTask> task;
  TaskTree task_tree;
  // elements
  Offset arena_size = 0, scratch_size = 0, packed_size = 0, vector_size = 0, gathered_size = 0;
  // of the padded fronts and the condensed nodes
  double flops = 0.0;

  Offset bytes() const;
};

// What of the kernels the layout follows.
struct KernelSizes {
  Index lanes, slab_rows, column_group;
  Offset (*packed_size)(const FrontShape&);
};

// The tree is of the nodes that are not condensed. condensed_at: see assign_condensed.
FactorLayout make_factor_layout(const SupernodeTree& tree, const CondensedGraph& graph,
                                std::span<const Index> condensed_at, const KernelSizes& sizes);

// The block of two nodes that has a place, at the one that is eliminated first (asserted).
Index find_block(const FactorLayout& layout, Index place, Index other);

// Tasks and places in the arena for a number of threads.
void plan_tasks(FactorLayout& layout, int threads);

}  // namespace taut
