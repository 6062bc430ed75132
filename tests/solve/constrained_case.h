#pragma once
// Random constrained systems for the solvers' tests, and their solution by a dense KKT system,
// which knows neither S nor U:
//
//   [A  Cᵀ] [x]   [ b ]
//   [C  0 ] [λ] = [C z]        C: one row for each prescribed direction, as it was given

#include "linalg/random_matrix.h"
#include "taut/solve/solver.h"

namespace taut::test {

struct ConstrainedCase {
  BlockCsr a;
  std::vector<double> b, z, guess;
  ConstraintSet constraints;
  std::vector<std::uint8_t> core;
  std::vector<std::pair<Index, Vec3>> rows;  // of C: node and direction

  Index size() const { return a.dofs(); }
  LinearSystem system() const {
    LinearSystem s;
    s.matrix = &a, s.rhs = b, s.constraints = &constraints, s.z = z, s.guess = guess,
    s.core.mask = core;
    return s;
  }
  void constrain(Index node, const Vec3& direction) {
    constraints.constrain(node, direction, 0.0);
    rows.emplace_back(node, direction);
  }
  void fix(Index node) {
    constraints.fix(node, Vec3::Zero());
    for (int c = 0; c < 3; ++c) rows.emplace_back(node, Vec3::Unit(c));
  }

  // S, made from the directions alone.
  Eigen::MatrixXd projection() const {
    const Eigen::MatrixXd c = constraint_rows();
    const Eigen::MatrixXd s = Eigen::MatrixXd::Identity(size(), size());
    if (rows.empty()) return s;
    return s - c.transpose() * (c * c.transpose()).llt().solve(c);
  }
  Eigen::MatrixXd constraint_rows() const {
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(static_cast<Index>(rows.size()), size());
    for (std::size_t k = 0; k < rows.size(); ++k)
      c.block<1, 3>(static_cast<Index>(k), 3 * rows[k].first) = rows[k].second.transpose();
    return c;
  }
  Eigen::VectorXd solution() const {
    const Index n = size(), m = static_cast<Index>(rows.size());
    const Eigen::MatrixXd c = constraint_rows();
    Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + m, n + m);
    kkt.topLeftCorner(n, n) = dense(a);
    kkt.topRightCorner(n, m) = c.transpose();
    kkt.bottomLeftCorner(m, n) = c;
    Eigen::VectorXd rhs(n + m);
    rhs << as_eigen(b), c * as_eigen(z);
    return kkt.fullPivLu().solve(rhs).head(n);
  }
  Eigen::MatrixXd dense_u() const {
    Eigen::MatrixXd u = Eigen::MatrixXd::Zero(size(), constraints.free_dofs());
    Index column = 0;
    for (Index i = 0; i < constraints.nodes(); ++i)
      for (int k = 0; k < constraints.ndof(i); ++k)
        u.block<3, 1>(3 * i, column++) = constraints.frame(i).col(k);
    return u;
  }
};

struct CaseOptions {
  Index nodes = 30;
  FrameChoice frames = FrameChoice::duff;
  int only = -1;         // every node's ndof, or a mix
  double margin = 0.05;  // of diagonal dominance: smaller is worse conditioned
};

// b, z, guess random and not zero anywhere: z has parts along free directions, which must be
// ignored.
inline ConstrainedCase random_case(Random& random, const CaseOptions& options) {
  ConstrainedCase c;
  const Index nodes = options.nodes;
  c.a = random_spd(random, make_pattern(random_graph(random, nodes, 3, 12), 3), options.margin);
  c.b = random.vector(3 * nodes), c.z = random.vector(3 * nodes),
  c.guess = random.vector(3 * nodes);
  c.constraints.reset(nodes, options.frames);
  for (Index i = 0; i < nodes; ++i) {
    const int ndof = options.only >= 0 ? options.only : random.below(4);
    if (ndof == 0) c.fix(i);
    if (ndof == 1 || ndof == 2) {
      // Both poles of Eq. 13 and of Duff's frame among the normals.
      const Vec3 poles[] = {Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitZ(), -Vec3::UnitZ()};
      const Vec3 first = random.below(3) == 0 ? poles[random.below(4)] : random.direction();
      c.constrain(i, first);
      Vec3 second = random.direction();
      while (second.cross(first).norm() < 0.3) second = random.direction();
      if (ndof == 1) c.constrain(i, second);
    }
  }
  // Blocks of the chain's links count as core.
  const BlockPattern& p = *c.a.pattern;
  c.core.resize(static_cast<std::size_t>(p.blocks()));
  for (Index i = 0; i < nodes; ++i)
    for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
      c.core[k] = std::abs(p.column[k] - i) <= 1;
  return c;
}

inline SolverOptions solver_options(const std::string& name, double tolerance) {
  SolverOptions options;
  options.name = name;
  options.tolerance = tolerance;
  return options;
}

// "cholmod" or "pardiso" in the programs that repeat the tests for that backend's sake: their
// main() says it before the tests are listed.
inline std::string backend_under_test;

// One case each: all solvers of this program, or those that the backend makes.
inline std::vector<std::string> solvers_to_test() {
  std::vector<std::string> names = solver_names();
  // core_pcg takes CHOLMOD where it is.
  if (!backend_under_test.empty())
    std::erase_if(names, [](const std::string& name) {
      return name.find(backend_under_test) == std::string::npos && name != "core_pcg";
    });
  return names;
}

// Solver names as names of test cases: "upcg:diagonal" is "upcg_diagonal".
inline std::string test_name(std::string name) {
  std::ranges::replace(name, ':', '_');
  return name;
}

}  // namespace taut::test
