#include "taut/results/stored_constraints.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

#include "taut/base/error.h"

namespace taut {

namespace {

constexpr double tolerance = 1e-9;

class ConstraintReader {
 public:
  ConstraintReader(const MatrixMarket& matrix, Index nodes, const std::string& name)
      : matrix_(matrix), nodes_(nodes), name_(name) {
    if (matrix.dense) fail("is a dense array; S or U as sparse matrix (coordinate) was expected");
    if (matrix.rows != 3 * nodes || matrix.columns > 3 * nodes)
      fail(
          fmt::format("has {} rows and {} columns; S with {} rows and columns, or U with as many "
                      "rows and at most as many columns, was expected",
                      matrix.rows, matrix.columns, 3 * nodes));
  }

  ConstraintSet read() const {
    return matrix_.rows == matrix_.columns && is_block_diagonal() && is_projection()
               ? from_projection()
               : from_columns();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError({name_}, what); }

  bool is_block_diagonal() const {
    for (const MatrixEntry& e : matrix_.entries)
      if (e.row / 3 != e.column / 3 && e.value != 0.0) return false;
    return true;
  }

  std::vector<Mat3> blocks() const {
    std::vector<Mat3> result(static_cast<std::size_t>(nodes_), Mat3::Zero());
    for (const MatrixEntry& e : matrix_.entries)
      if (e.row / 3 == e.column / 3) result[e.row / 3](e.row % 3, e.column % 3) = e.value;
    return result;
  }

  bool is_projection() const {
    for (const Mat3& s : blocks())
      if ((s - s.transpose()).norm() > tolerance || (s * s - s).norm() > tolerance) return false;
    return true;
  }

  ConstraintSet from_projection() const {
    ConstraintSet constraints(nodes_);
    const std::vector<Mat3> s = blocks();
    for (Index i = 0; i < nodes_; ++i) {
      // Eigenvalues ascend: 0 for what is prescribed, 1 for what is free.
      const Eigen::SelfAdjointEigenSolver<Mat3> eigen(s[i]);
      Mat3 frame = eigen.eigenvectors().rowwise().reverse();
      if (frame.determinant() < 0.0) frame.col(0) *= -1.0;
      constraints.set_frame(i, static_cast<int>(std::lround(s[i].trace())), frame);
    }
    return constraints;
  }

  ConstraintSet from_columns() const {
    std::vector<Mat3> u(static_cast<std::size_t>(nodes_), Mat3::Zero());
    std::vector<int> ndof(static_cast<std::size_t>(nodes_), 0);
    std::vector<Index> node_of(static_cast<std::size_t>(matrix_.columns), -1),
        place_of(node_of.size(), 0);
    for (const MatrixEntry& e : matrix_.entries) {
      if (e.value == 0.0) continue;
      const Index node = e.row / 3;
      if (node_of[e.column] < 0) {
        node_of[e.column] = node;
        place_of[e.column] = ndof[node]++;
        if (ndof[node] > 3)
          fail(fmt::format("node {} (rows {} to {}) has more than three columns", node,
                           3 * node + 1, 3 * node + 3));
      }
      if (node_of[e.column] != node)
        fail(
            fmt::format("column {} has entries in rows {} and {}, of two nodes; each free "
                        "direction belongs to one node",
                        e.column + 1, 3 * node_of[e.column] + 1, e.row + 1));
      u[node](e.row % 3, place_of[e.column]) = e.value;
    }
    ConstraintSet constraints(nodes_);
    for (Index i = 0; i < nodes_; ++i)
      constraints.set_frame(i, ndof[i], completed(u[i], ndof[i], i));
    return constraints;
  }

  Mat3 completed(Mat3 u, int ndof, Index node) const {
    const Eigen::MatrixXd columns = u.leftCols(ndof);
    if ((columns.transpose() * columns - Eigen::MatrixXd::Identity(ndof, ndof)).norm() > tolerance)
      fail(
          fmt::format("the columns of node {} (rows {} to {}) are not orthonormal; S = projection "
                      "or U with U'U = I was expected",
                      node, 3 * node + 1, 3 * node + 3));
    if (ndof == 0) return Mat3::Identity();
    if (ndof == 1) {
      const auto [a, b] = orthonormal_complement(u.col(0));
      u.col(1) = a, u.col(2) = b;
    } else {
      u.col(2) = u.col(0).cross(u.col(1));
    }
    return u;
  }

  const MatrixMarket& matrix_;
  Index nodes_;
  const std::string& name_;
};

}  // namespace

ConstraintSet to_constraints(const MatrixMarket& matrix, Index nodes, const std::string& name) {
  return ConstraintReader(matrix, nodes, name).read();
}

}  // namespace taut
