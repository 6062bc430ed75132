#include <cassert>
#include <ostream>
#include <sstream>

#include "taut/base/file.h"
#include "taut/io/matrix_market.h"
#include "taut/io/shortest_decimal.h"

namespace taut {

namespace {

std::string header(const char* kind, const std::string& comment) {
  std::string text = std::string("%%MatrixMarket matrix ") + kind + '\n';
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) text += "% " + line + '\n';
  return text;
}

void write_entry(std::ostream& out, std::string& line, Offset row, Offset column, double value) {
  line = std::to_string(row + 1);
  line += ' ';
  line += std::to_string(column + 1);
  line += ' ';
  append_decimal(line, value);
  out << (line += '\n');
}

// Calls visit(row, column, value) for each stored entry of the lower triangle, row after row.
template <class Visit>
void for_each_lower(const BlockCsr& a, Visit visit) {
  const BlockPattern& p = *a.pattern;
  for (Index i = 0; i < p.rows(); ++i)
    for (Index r = 0; r < p.dim(i); ++r)
      for (Index k = p.row_start[i]; k <= p.diagonal[i]; ++k) {
        const double* block_row = a.block(i, k) + static_cast<Offset>(r) * p.width(i);
        const Index first = p.dof_start[p.column[k]];
        const Index end = k == p.diagonal[i] ? r + 1 : p.dim(p.column[k]);
        for (Index c = 0; c < end; ++c) visit(p.dof_start[i] + r, first + c, block_row[c]);
      }
}

}  // namespace

void write_symmetric_matrix(const std::filesystem::path& path, const BlockCsr& matrix,
                            const std::string& comment) {
  Offset count = 0;
  for_each_lower(matrix, [&](Index, Index, double) { ++count; });
  write_file(path, [&](std::ostream& out) {
    out << header("coordinate real symmetric", comment) << matrix.dofs() << ' ' << matrix.dofs()
        << ' ' << count << '\n';
    std::string line;
    for_each_lower(matrix, [&](Index row, Index column, double value) {
      write_entry(out, line, row, column, value);
    });
  });
}

namespace {

void write_coordinates(const std::filesystem::path& path, const char* kind, Index rows,
                       Index columns, std::span<const MatrixEntry> entries,
                       const std::string& comment) {
  write_file(path, [&](std::ostream& out) {
    out << header(kind, comment) << rows << ' ' << columns << ' ' << entries.size() << '\n';
    std::string line;
    for (const MatrixEntry& entry : entries) {
      assert(entry.row >= 0 && entry.row < rows && entry.column >= 0 && entry.column < columns);
      write_entry(out, line, entry.row, entry.column, entry.value);
    }
  });
}

}  // namespace

void write_symmetric_matrix(const std::filesystem::path& path, Index rows,
                            std::span<const MatrixEntry> lower, const std::string& comment) {
  for ([[maybe_unused]] const MatrixEntry& entry : lower) assert(entry.row >= entry.column);
  write_coordinates(path, "coordinate real symmetric", rows, rows, lower, comment);
}

void write_general_matrix(const std::filesystem::path& path, Index rows, Index columns,
                          std::span<const MatrixEntry> entries, const std::string& comment) {
  write_coordinates(path, "coordinate real general", rows, columns, entries, comment);
}

void write_vector(const std::filesystem::path& path, std::span<const double> vector,
                  const std::string& comment) {
  write_file(path, [&](std::ostream& out) {
    out << header("array real general", comment) << vector.size() << " 1\n";
    std::string line;
    for (const double value : vector) {
      line.clear();
      append_decimal(line, value);
      out << (line += '\n');
    }
  });
}

}  // namespace taut
