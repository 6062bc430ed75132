#pragma once
// A linear system read from Matrix Market files: a dump of Taut's (results/dump.h), or anyone's
// symmetric positive definite matrix.
//
//   matrix       A, symmetric; checked by to_system_matrix (io/matrix_market.h)
//   rhs          b; not given: A times ones
//   constraints  S or U as in a dump. S: projection, block diagonal in 3x3 blocks; U: orthonormal
//                columns, each in the rows of one node
//   z            the prescribed part of the solution; not given: 0. Only with constraints
//   core         a matrix made of some of A's entries, its whole diagonal (blocks) among them: what
//                core_pcg factorises
//   guess        where iterative solvers start; not given: 0
//   masses       M: then ρ of the core is known, which bounds corePCG's iterations
//   positions    of the nodes, for multigrid's rotations; not given: it does without
//
// With constraints, or from a dump, a node is three consecutive rows and A gets 3x3 blocks; else
// each row is a node of its own. Everything that does not fit is an InputError that names the file
// and, where there is one, the row and column (from 1).

#include <filesystem>
#include <optional>

#include "taut/solve/linear_system.h"

namespace taut {

struct SystemFiles {
  // empty: not given
  std::filesystem::path matrix, rhs, constraints, z, core, guess, positions, masses;
  bool nodes_of_three = false;  // constraints imply it
  // LinearSystem::stiffness, where it is known
  double stiffness = -1.0;
};

// The files of a dump. Throws InputError when the folder is none, or not complete.
SystemFiles files_of_dump(const std::filesystem::path& folder);

class StoredSystem {
 public:
  explicit StoredSystem(const SystemFiles& files);
  // Valid as long as this is.
  LinearSystem system() const;
  Index unknowns() const { return matrix_.dofs(); }

 private:
  void read_constraints(const SystemFiles& files);
  void read_core(const std::filesystem::path& path);
  void read_masses(const std::filesystem::path& path);

  BlockCsr matrix_;
  std::vector<double> rhs_, z_, guess_, positions_;
  std::optional<ConstraintSet> constraints_;
  std::vector<std::uint8_t> core_;
  std::vector<double> masses_;
  double rho_ = -1.0, stiffness_ = -1.0;
};

}  // namespace taut
