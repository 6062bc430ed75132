#pragma once
// Matrix Market files: sparse matrices ("coordinate"), dense ones and vectors ("array"), as text
// (Boisvert, Pozo, Remington, "The Matrix Market exchange formats: initial design", NISTIR 5935,
// 1996). What is read, and how strictly: docs/design/readers.md.
//
//   object      matrix, vector
//   format      coordinate, array
//   field       real, double, integer, pattern
//   symmetry    general, symmetric, skew-symmetric
//
// Throws InputError that names file, line and column. Time is O(n log n), memory linear in the size
// of the file, whatever its header announces. Writing goes through a temporary file and uses the
// shortest decimals that read back to the same doubles (17 digits at most).

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "taut/linalg/block_csr.h"

namespace taut {

enum class MatrixSymmetry { general, symmetric, skew_symmetric };

struct MatrixEntry {
  Index row = 0, column = 0;  // from 0
  double value = 0;
  bool operator==(const MatrixEntry&) const = default;
};

struct MatrixMarket {
  Index rows = 0, columns = 0;
  // entries and values hold both triangles whatever was declared
  MatrixSymmetry declared = MatrixSymmetry::general;
  bool dense = false;
  // if not dense: sorted by row, then column, no two alike; zeros that the file names are kept
  std::vector<MatrixEntry> entries;
  std::vector<double> values;  // if dense: rows x columns, column after column
};

MatrixMarket read_matrix_market(const std::filesystem::path& path);

// A vector: an array of one column, or a sparse one with zeros where it names nothing. Refused
// unless it has `rows` rows.
std::vector<double> read_vector(const std::filesystem::path& path, Index rows);

// The matrix of a linear system with one unknown a node (1x1 blocks). Throws InputError("NAME:
// ...") that names row and column (from 1) when it is not square, empty, skew-symmetric, not
// finite, has a missing or zero diagonal entry, or is not symmetric:
//   |a_ij - a_ji| <= 1e-10 sqrt(|a_ii a_jj|) is taken for rounding, and the mean of both is used.
// Whether it is positive definite is left to the solver.
BlockCsr to_system_matrix(const MatrixMarket& matrix, const std::string& name);

// Symmetric, coordinate: the lower triangle of what is stored, zeros in blocks too. `comment` may
// have several lines.
void write_symmetric_matrix(const std::filesystem::path& path, const BlockCsr& matrix,
                            const std::string& comment = {});
// The same from entries with row >= column (asserted).
void write_symmetric_matrix(const std::filesystem::path& path, Index rows,
                            std::span<const MatrixEntry> lower, const std::string& comment = {});
// General, coordinate.
void write_general_matrix(const std::filesystem::path& path, Index rows, Index columns,
                          std::span<const MatrixEntry> entries, const std::string& comment = {});
// Array of one column.
void write_vector(const std::filesystem::path& path, std::span<const double> vector,
                  const std::string& comment = {});

}  // namespace taut
