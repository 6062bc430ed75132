#pragma once
// A linear system read from Matrix Market files: a dump of Taut's (results/dump.h), or anyone's
// symmetric positive definite matrix A. What is not given:
//
//   rhs          A times ones            z, guess      0; z only with constraints
//   masses       ρ of the core is unknown, and no bound on corePCG's iterations
//   positions    multigrid does without rotations
//   constraints  S: projection, block diagonal in 3x3 blocks; or U: orthonormal columns, each in
//                the rows of one node
//   core         a matrix of some of A's entries, its whole diagonal (blocks) among them
//
// With constraints, or from a dump, a node is three consecutive rows and A gets 3x3 blocks; else
// each row is a node. What does not fit is an InputError that names file, row and column (from 1).

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
