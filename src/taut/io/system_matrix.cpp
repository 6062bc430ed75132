// to_system_matrix of io/matrix_market.h.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>

#include "taut/base/error.h"
#include "taut/io/matrix_market.h"

namespace taut {

namespace {

// Of the scale sqrt(|a_ii a_jj|), which bounds |a_ij| in a positive definite matrix.
constexpr double symmetry_tolerance = 1e-10;

std::string at(Index row, Index column) {
  return "(" + std::to_string(Offset{row} + 1) + ", " + std::to_string(Offset{column} + 1) + ")";
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

class SystemMatrixBuilder {
 public:
  SystemMatrixBuilder(const MatrixMarket& matrix, const std::string& name)
      : name_(name), entries_(matrix.entries) {
    if (matrix.rows != matrix.columns || matrix.rows == 0)
      fail("has " + std::to_string(matrix.rows) + " rows and " + std::to_string(matrix.columns) +
           " columns, a square matrix was expected");
    if (matrix.declared == MatrixSymmetry::skew_symmetric)
      fail(
          "is skew-symmetric, so its diagonal is zero; a symmetric positive definite matrix was "
          "expected");
    rows_ = matrix.rows;
    if (matrix.dense) take_dense(matrix.values);
  }

  BlockCsr build() {
    check_finite();
    check_diagonal();
    check_symmetry();
    std::vector<Index> row_start(static_cast<std::size_t>(rows_) + 1, 0), column,
        dof_start(row_start.size());
    std::iota(dof_start.begin(), dof_start.end(), 0);
    for (const MatrixEntry& entry : entries_) {
      ++row_start[entry.row + 1];
      column.push_back(entry.column);
    }
    std::partial_sum(row_start.begin(), row_start.end(), row_start.begin());
    // A scalar row's panel is its entries in order, so the values are the entries' values.
    BlockCsr matrix(make_pattern(std::move(row_start), std::move(column), std::move(dof_start)));
    for (std::size_t k = 0; k < entries_.size(); ++k) matrix.values[k] = entries_[k].value;
    return matrix;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError({name_}, message); }

  void take_dense(const std::vector<double>& values) {
    const std::size_t n = static_cast<std::size_t>(rows_);
    for (std::size_t row = 0; row < n; ++row)
      for (std::size_t column = 0; column < n; ++column)
        if (values[column * n + row] != 0)
          entries_.push_back(
              {static_cast<Index>(row), static_cast<Index>(column), values[column * n + row]});
  }

  void check_finite() const {
    for (const MatrixEntry& entry : entries_)
      if (!std::isfinite(entry.value))
        fail("entry " + at(entry.row, entry.column) + " is not finite");
  }

  void check_diagonal() {
    // Before any memory for `rows_` rows is taken: a header may announce
    // millions of rows and hold none.
    std::vector<double> found;
    for (const MatrixEntry& entry : entries_) {
      if (entry.row != entry.column) continue;
      if (entry.row != static_cast<Index>(found.size()) || entry.value == 0) break;
      found.push_back(entry.value);
    }
    const auto first_missing = static_cast<Index>(found.size());
    if (first_missing < rows_)
      fail("the diagonal entry " + at(first_missing, first_missing) +
           " is zero or missing; a positive definite matrix has a positive diagonal");
    diagonal_ = std::move(found);
  }

  // Stores (a_ij + a_ji) / 2 in both places after checking that they agree;
  // exact where they are equal.
  void check_symmetry() {
    std::vector<MatrixEntry> mirrored(entries_);
    for (MatrixEntry& entry : mirrored) std::swap(entry.row, entry.column);
    const auto before = [](const MatrixEntry& a, const MatrixEntry& b) {
      return std::pair(a.row, a.column) < std::pair(b.row, b.column);
    };
    std::sort(mirrored.begin(), mirrored.end(), before);
    std::vector<MatrixEntry> mean;
    mean.reserve(entries_.size());
    auto a = entries_.begin();
    auto b = mirrored.begin();
    while (a != entries_.end() || b != mirrored.end()) {
      const bool has_a = b == mirrored.end() || (a != entries_.end() && !before(*b, *a));
      const bool has_b = a == entries_.end() || (b != mirrored.end() && !before(*a, *b));
      mean.push_back(mean_of(has_a ? *a : *b, has_a ? a->value : 0.0, has_b ? b->value : 0.0));
      a += has_a;
      b += has_b;
    }
    entries_ = std::move(mean);
  }

  MatrixEntry mean_of(const MatrixEntry& place, double value, double mirror) const {
    const double scale =
        std::sqrt(std::abs(diagonal_[place.row])) * std::sqrt(std::abs(diagonal_[place.column]));
    if (std::abs(value - mirror) > symmetry_tolerance * scale)
      fail("is not symmetric: entry " + at(place.row, place.column) + " is " + number(value) +
           ", but entry " + at(place.column, place.row) + " is " + number(mirror) +
           "; a symmetric positive definite matrix was expected");
    return {place.row, place.column, value == mirror ? value : 0.5 * value + 0.5 * mirror};
  }

  std::string name_;
  std::vector<MatrixEntry> entries_;
  std::vector<double> diagonal_;
  Index rows_ = 0;
};

}  // namespace

BlockCsr to_system_matrix(const MatrixMarket& matrix, const std::string& name) {
  return SystemMatrixBuilder(matrix, name).build();
}

}  // namespace taut
