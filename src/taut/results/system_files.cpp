#include "taut/results/system_files.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/core/core_bound.h"
#include "taut/io/matrix_market.h"
#include "taut/results/stored_constraints.h"

namespace taut {

namespace fs = std::filesystem;

namespace {

// Blocks of 3x3 from a scalar matrix: where three rows and columns of a node pair hold any entry,
// there is a block.
BlockCsr in_blocks_of_three(const BlockCsr& scalar, const fs::path& file) {
  if (scalar.rows() % 3 != 0)
    throw InputError(
        {file.string()},
        fmt::format(
            "has {} rows, which is no multiple of 3: constraints belong to nodes of three unknowns",
            scalar.rows()));
  const BlockPattern& p = *scalar.pattern;
  const Index nodes = scalar.rows() / 3;
  std::vector<std::vector<Index>> columns(static_cast<std::size_t>(nodes));
  for (Index i = 0; i < p.rows(); ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
      columns[i / 3].push_back(p.column[k] / 3);
  BlockCsr a(make_pattern(std::move(columns), 3));
  for (Index i = 0; i < p.rows(); ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
      const Index node = i / 3, j = p.column[k];
      a.block(node, a.pattern->find(node, j / 3))[(i % 3) * a.pattern->width(node) + j % 3] =
          scalar.values[static_cast<std::size_t>(k)];
    }
  return a;
}

// -1 where an older dump does not tell.
double stiffness_in(const fs::path& meta) {
  const nlohmann::json json = nlohmann::json::parse(read_file(meta), nullptr, false);
  if (!json.is_object())
    throw InputError({meta.string()},
                     "is no JSON object: it is damaged, or not of `taut dump`; dump the system "
                     "anew, or name the files (--matrix, --rhs, "
                     "--constraints, --core)");
  const auto it = json.find("stiffness");
  return it != json.end() && it->is_number() ? it->get<double>() : -1.0;
}

}  // namespace

SystemFiles files_of_dump(const fs::path& folder) {
  if (!fs::is_directory(folder))
    throw InputError({folder.string()},
                     "is no folder; give one that `taut dump` has written, or --matrix A.mtx");
  if (!fs::exists(folder / "meta.json"))
    throw InputError({folder.string()},
                     "has no meta.json: it is not a dump, or one that was interrupted; write it "
                     "with `taut dump`, or use --matrix A.mtx");
  const auto if_there = [&](const char* name) {
    return fs::exists(folder / name) ? folder / name : fs::path();
  };
  return {folder / "A.mtx",
          folder / "b.mtx",
          folder / "U.mtx",
          folder / "z.mtx",
          if_there("A_core.mtx"),
          if_there("guess.mtx"),
          if_there("x.mtx"),
          if_there("M.mtx"),
          true,
          stiffness_in(folder / "meta.json")};
}

StoredSystem::StoredSystem(const SystemFiles& files)
    : matrix_(to_system_matrix(read_matrix_market(files.matrix), files.matrix.string())) {
  if (files.nodes_of_three || !files.constraints.empty())
    matrix_ = in_blocks_of_three(matrix_, files.matrix);
  const Index n = matrix_.dofs();
  rhs_.assign(static_cast<std::size_t>(n), 0.0);
  if (files.rhs.empty()) {
    multiply(matrix_, std::vector<double>(rhs_.size(), 1.0), rhs_);
  } else {
    rhs_ = read_vector(files.rhs, n);
  }
  stiffness_ = files.stiffness;
  read_constraints(files);
  if (!files.guess.empty()) guess_ = read_vector(files.guess, n);
  if (!files.positions.empty()) positions_ = read_vector(files.positions, n);
  if (!files.core.empty()) read_core(files.core);
  if (!files.core.empty() && !files.masses.empty()) read_masses(files.masses);
}

void StoredSystem::read_constraints(const SystemFiles& files) {
  if (files.constraints.empty()) {
    if (!files.z.empty())
      throw InputError({files.z.string()},
                       "prescribes parts of the solution, but which ones is not known: give "
                       "--constraints as well");
    return;
  }
  constraints_ = to_constraints(read_matrix_market(files.constraints), matrix_.rows(),
                                files.constraints.string());
  z_.assign(rhs_.size(), 0.0);
  if (!files.z.empty()) z_ = read_vector(files.z, matrix_.dofs());
}

void StoredSystem::read_core(const fs::path& path) {
  const MatrixMarket core = read_matrix_market(path);
  const BlockPattern& p = *matrix_.pattern;
  const Index dim = p.uniform_dim, n = matrix_.dofs();
  const auto fail = [&](Index row, Index column, const std::string& what) {
    throw InputError(
        {path.string()},
        fmt::format(
            "entry ({}, {}) {}: the core is made of entries of the matrix, taken or left out",
            row + 1, column + 1, what));
  };
  if (core.dense || core.rows != n || core.columns != n)
    throw InputError(
        {path.string()},
        fmt::format("a sparse matrix of {} rows and columns was expected, as the system's", n));
  core_.assign(static_cast<std::size_t>(p.blocks()), 0);
  std::vector<double> copied(matrix_.values.size(), 0.0);
  const auto place = [&](Index row, Index column) {
    const Index k = p.find(row / dim, column / dim);
    return k < 0 ? Offset{-1}
                 : matrix_.block(row / dim, k) - matrix_.values.data() +
                       row % dim * p.width(row / dim) + column % dim;
  };
  for (const MatrixEntry& entry : core.entries) {
    const Offset at = place(entry.row, entry.column);
    if (at < 0) fail(entry.row, entry.column, "is not there in the matrix");
    core_[p.find(entry.row / dim, entry.column / dim)] = 1;
    copied[static_cast<std::size_t>(at)] = entry.value;
  }
  for (Index i = 0; i < p.rows(); ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
      for (Index r = 0; r < dim; ++r)
        for (Index c = 0; c < dim; ++c) {
          const Index row = dim * i + r, column = dim * p.column[k] + c;
          const auto at = static_cast<std::size_t>(place(row, column));
          if ((core_[k] || k == p.diagonal[i]) &&
              std::abs(copied[at] - matrix_.values[at]) > 1e-12 * std::abs(matrix_.values[at]))
            fail(
                row, column,
                fmt::format("is {:.9g}, but {:.9g} in the matrix", copied[at], matrix_.values[at]));
        }
}

void StoredSystem::read_masses(const fs::path& path) {
  const std::vector<double> of_unknowns = read_vector(path, matrix_.dofs());
  for (std::size_t i = 0; i < of_unknowns.size(); i += 3) masses_.push_back(of_unknowns[i]);
  for (const double m : masses_)
    if (!(m > 0.0))
      throw InputError({path.string()}, fmt::format("holds {:.9g}: masses are positive", m));
  // The file does not say which elements are outside the core.
  if (may_be_springs(matrix_, core_)) rho_ = remainder_ratio(matrix_, core_, masses_);
  if (stiffness_ < 0.0) stiffness_ = 0.5 * block_diagonal_condition(matrix_) - 1.0;
}

LinearSystem StoredSystem::system() const {
  LinearSystem system;
  system.matrix = &matrix_;
  system.rhs = rhs_;
  system.guess = system.last = guess_;
  system.core = {"file", core_, rho_};
  system.stiffness = stiffness_;
  system.masses = masses_;
  system.positions = positions_;
  if (constraints_) {
    system.constraints = &*constraints_;
    system.z = z_;
  }
  return system;
}

}  // namespace taut
