#include "taut/element/assembler.h"

#include <algorithm>
#include <cassert>

#include "taut/base/parallel.h"
#include "taut/base/simd.h"

namespace taut {

namespace {

constexpr Index rows_per_task = 128;

// A sink that ignores what it is not made for.
struct MatrixSink : ConnectionSink {
  std::function<void(Index, Index, Index, int, bool)> on_matrix;
  void matrix(Index id, Index row, Index column, int sign, bool transposed) override {
    on_matrix(id, row, column, sign, transposed);
  }
  void vector(Index, Index, int) override {}
};

struct VectorSink : ConnectionSink {
  std::function<void(Index, Index, int)> on_vector;
  void matrix(Index, Index, Index, int, bool) override {}
  void vector(Index id, Index node, int sign) override { on_vector(id, node, sign); }
};

// sum += sign b, or of bᵀ.
TAUT_ALWAYS_INLINE void add_block(const double* b, double sign, bool transposed, double (&sum)[9]) {
  if (transposed) {
    for (int r = 0; r < 3; ++r)
      for (int q = 0; q < 3; ++q) sum[3 * r + q] += sign * b[3 * q + r];
  } else {
    for (int e = 0; e < 9; ++e) sum[e] += sign * b[e];
  }
}

// Runs `visit(add)` twice: once to count, once to place; `add(slot, entry)` appends entry to the
// slot's list, in order of calls.
template <class Entry, class Visit>
void build_lists(Index slots, std::vector<Index>& start, std::vector<Entry>& list, Visit visit) {
  start.assign(static_cast<std::size_t>(slots) + 1, 0);
  visit([&](Index slot, Entry) { ++start[slot + 1]; });
  for (Index s = 0; s < slots; ++s) start[s + 1] += start[s];
  list.resize(static_cast<std::size_t>(start.back()));
  std::vector<Index> next(start.begin(), start.end() - 1);
  visit([&](Index slot, Entry entry) { list[next[slot]++] = entry; });
}

}  // namespace

Assembler::Assembler(Index nodes, std::vector<const ForceModel*> models, std::vector<bool> implicit)
    : models_(std::move(models)), implicit_(std::move(implicit)) {
  assert(models_.size() == implicit_.size());
  block_base_.assign(models_.size() + 1, 0);
  vector_base_.assign(models_.size() + 1, 0);
  for (std::size_t m = 0; m < models_.size(); ++m) {
    block_base_[m + 1] = block_base_[m] + (implicit_[m] ? models_[m]->block_count() : 0);
    vector_base_[m + 1] = vector_base_[m] + models_[m]->vector_count();
  }
  blocks_.resize(9 * static_cast<std::size_t>(block_base_.back()));
  vectors_.resize(static_cast<std::size_t>(vector_base_.back()));
  build_pattern(nodes);
  build_gather(nodes);
}

void Assembler::build_pattern(Index nodes) {
  std::vector<std::vector<Index>> columns(static_cast<std::size_t>(nodes));
  MatrixSink sink;
  sink.on_matrix = [&](Index, Index row, Index column, int, bool) {
    columns[row].push_back(column);
  };
  for (std::size_t m = 0; m < models_.size(); ++m)
    if (implicit_[m]) models_[m]->connect(sink);
  pattern_ = make_pattern(std::move(columns), 3);
}

void Assembler::build_gather(Index nodes) {
  const auto encode = [](Index id, int sign, bool transposed) {
    return Contribution{(static_cast<std::uint32_t>(id) << 2) | (transposed ? 2u : 0u) |
                        (sign < 0 ? 1u : 0u)};
  };
  build_lists<Contribution>(pattern_->blocks(), block_start_, block_list_, [&](auto add) {
    for (std::size_t m = 0; m < models_.size(); ++m) {
      if (!implicit_[m]) continue;
      MatrixSink sink;
      sink.on_matrix = [&](Index id, Index row, Index column, int sign, bool transposed) {
        add(pattern_->find(row, column), encode(block_base_[m] + id, sign, transposed));
      };
      models_[m]->connect(sink);
    }
  });
  build_lists<Contribution>(nodes, vector_start_, vector_list_, [&](auto add) {
    for (std::size_t m = 0; m < models_.size(); ++m) {
      VectorSink sink;
      sink.on_vector = [&](Index id, Index node, int sign) {
        add(node, encode(vector_base_[m] + id, sign, false));
      };
      models_[m]->connect(sink);
    }
  });
}

std::vector<std::uint8_t> Assembler::core_mask(ForceClass core_class) const {
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(pattern_->blocks()), 0);
  for (const Index k : pattern_->diagonal) mask[k] = 1;
  MatrixSink sink;
  sink.on_matrix = [&](Index, Index row, Index column, int, bool) {
    mask[pattern_->find(row, column)] = 1;
  };
  for (std::size_t m = 0; m < models_.size(); ++m)
    if (implicit_[m] && models_[m]->force_class() == core_class) models_[m]->connect(sink);
  return mask;
}

// Of the blocks of the flat arrays.
std::vector<double> Assembler::own_bounds(double matrix_stiffness, double matrix_damping) const {
  std::vector<double> own(static_cast<std::size_t>(block_base_.back()));
  for (std::size_t m = 0; m < models_.size(); ++m)
    if (implicit_[m])
      models_[m]->bound_blocks(
          matrix_stiffness, matrix_damping,
          std::span(own).subspan(block_base_[m], block_base_[m + 1] - block_base_[m]));
  return own;
}

std::vector<double> Assembler::block_bounds(double matrix_stiffness, double matrix_damping) const {
  std::vector<double> own = own_bounds(matrix_stiffness, matrix_damping),
                      bounds(static_cast<std::size_t>(pattern_->blocks()), 0.0);
  for (std::size_t m = 0; m < models_.size(); ++m)
    if (has_larger_elements(m))
      std::fill(own.begin() + block_base_[m], own.begin() + block_base_[m + 1], 0.0);
  for (Index i = 0; i < pattern_->rows(); ++i)
    for (Index k = pattern_->row_start[i]; k < pattern_->row_start[i + 1]; ++k) {
      if (k == pattern_->diagonal[i]) continue;
      for (Index c = block_start_[k]; c < block_start_[k + 1]; ++c)
        bounds[k] += own[block_list_[c].id()];
    }
  return bounds;
}

std::vector<LargerElement> Assembler::larger_elements(double matrix_stiffness,
                                                      double matrix_damping) const {
  const std::vector<double> own = own_bounds(matrix_stiffness, matrix_damping);
  std::vector<LargerElement> elements;
  for (std::size_t m = 0; m < models_.size(); ++m) {
    if (!has_larger_elements(m)) continue;
    const std::size_t first = elements.size();
    const Index blocks = models_[m]->blocks_per_element();
    elements.resize(first + static_cast<std::size_t>(models_[m]->block_count() / blocks));
    MatrixSink sink;
    sink.on_matrix = [&](Index id, Index row, Index column, int, bool) {
      if (row != column) return;
      LargerElement& e = elements[first + static_cast<std::size_t>(id / blocks)];
      assert(e.nodes < LargerElement::most_nodes);
      e.node[e.nodes] = row;
      e.weight[e.nodes++] = own[block_base_[m] + id];
    };
    models_[m]->connect(sink);
  }
  return elements;
}

CoreElements Assembler::elements_of(std::span<const std::uint8_t> mask) const {
  CoreElements core;
  core.is_outside.assign(static_cast<std::size_t>(block_base_.back()), 0);
  for (Index i = 0; i < pattern_->rows(); ++i)
    for (Index k = pattern_->row_start[i]; k < pattern_->row_start[i + 1]; ++k) {
      if (mask[k] || k == pattern_->diagonal[i]) continue;
      for (Index c = block_start_[k]; c < block_start_[k + 1]; ++c)
        core.is_outside[block_list_[c].id()] = 1;
    }
  for (std::size_t m = 0; m < models_.size(); ++m) {
    const Index blocks = models_[m]->blocks_per_element();
    for (Index first = block_base_[m]; first < block_base_[m + 1]; first += blocks) {
      const auto own = std::span(core.is_outside).subspan(first, blocks);
      if (std::ranges::count(own, 1) == 0) {
        ++core.inside;
        continue;
      }
      std::ranges::fill(own, 1);
      core.nodes_outside = std::max(core.nodes_outside, models_[m]->nodes_per_element());
    }
  }
  return core;
}

template <class IsTaken>
void Assembler::gather_row(Index i, IsTaken is_taken, BlockCsr& a) const {
  const BlockPattern& p = *pattern_;
  const Index width = p.width(i);
  for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
    double sum[9] = {};
    for (Index c = block_start_[k]; c < block_start_[k + 1]; ++c) {
      const Contribution from = block_list_[c];
      if (!is_taken(from.id())) continue;
      add_block(&blocks_[9 * static_cast<std::size_t>(from.id())], from.negative() ? -1.0 : 1.0,
                from.transposed(), sum);
    }
    if (k == p.diagonal[i]) {
      const double mass = diagonal_.mass * diagonal_.masses[i];
      for (int r = 0; r < 3; ++r) sum[4 * r] += mass;
      if (!diagonal_.damping.empty())
        for (int r = 0; r < 3; ++r)
          for (int q = 0; q < 3; ++q)
            sum[3 * r + q] += diagonal_.external * diagonal_.damping[i](r, q);
    }
    double* out = a.block(i, k);
    for (int r = 0; r < 3; ++r)
      for (int q = 0; q < 3; ++q) out[r * width + q] = sum[3 * r + q];
  }
}

void Assembler::gather_core(const CoreElements& core, BlockCsr& matrix) const {
  assert(matrix.pattern == pattern_ && !diagonal_.masses.empty());
  parallel_for(pattern_->rows(), rows_per_task, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      gather_row(i, [&](Index id) { return !core.is_outside[id]; }, matrix);
  });
}

void Assembler::gather_rest_diagonal(const CoreElements& core, std::span<Mat3> diagonal) const {
  assert(static_cast<Index>(diagonal.size()) == pattern_->rows());
  parallel_for(pattern_->rows(), rows_per_task, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Index k = pattern_->diagonal[i];
      double sum[9] = {};
      for (Index c = block_start_[k]; c < block_start_[k + 1]; ++c)
        if (const Contribution from = block_list_[c]; core.is_outside[from.id()])
          add_block(&blocks_[9 * static_cast<std::size_t>(from.id())], from.negative() ? -1.0 : 1.0,
                    from.transposed(), sum);
      diagonal[i] = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(sum);
    }
  });
}

void Assembler::assemble(std::span<const ForceRequest> requests, const Diagonal& diagonal,
                         BlockCsr& a, std::span<Vec3> b) {
  assert(requests.size() == models_.size() && a.pattern == pattern_ &&
         static_cast<Index>(b.size()) == pattern_->rows());
  for (std::size_t m = 0; m < models_.size(); ++m) {
    assert(implicit_[m] || !requests[m].wants_matrix());
    const auto block_part = std::span(blocks_).subspan(
        9 * static_cast<std::size_t>(block_base_[m]),
        9 * static_cast<std::size_t>(block_base_[m + 1] - block_base_[m]));
    const auto vector_part = std::span(vectors_).subspan(
        static_cast<std::size_t>(vector_base_[m]),
        static_cast<std::size_t>(vector_base_[m + 1] - vector_base_[m]));
    // An implicit model left out of this matrix (a dump of one class) must not leave its last
    // numbers behind.
    if (implicit_[m] && !requests[m].wants_matrix()) std::ranges::fill(block_part, 0.0);
    models_[m]->evaluate(requests[m], block_part, vector_part);
  }
  diagonal_ = diagonal;
  parallel_for(pattern_->rows(), rows_per_task, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      gather_row(i, [](Index) { return true; }, a);
      Vec3 sum = Vec3::Zero();
      for (Index c = vector_start_[i]; c < vector_start_[i + 1]; ++c) {
        const Contribution from = vector_list_[c];
        if (from.negative())
          sum -= vectors_[from.id()];
        else
          sum += vectors_[from.id()];
      }
      b[i] = sum;
    }
  });
}

}  // namespace taut
