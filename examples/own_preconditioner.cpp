// A preconditioner and a solver of one's own in a simulation, by name: block Jacobi for conjugate
// gradients, and a solver that counts what it passes on.
#include <taut/taut.h>

#include <Eigen/Dense>
#include <cstdio>

namespace {

// M_p = the 3x3 (or smaller) diagonal blocks of the matrix.
class BlockJacobi : public taut::Preconditioner {
 public:
  taut::Status update(const taut::BlockCsr& a) override {
    pattern_ = a.pattern;
    inverse_.clear();
    for (taut::Index i = 0; i < a.rows(); ++i) {
      const taut::Index dim = pattern_->dim(i), width = pattern_->width(i);
      const Eigen::Map<const Block, 0, Eigen::OuterStride<>> block(
          a.block(i, pattern_->diagonal[i]), dim, dim, Eigen::OuterStride<>(width));
      inverse_.push_back(block.inverse());
    }
    return {};
  }
  void apply(std::span<const double> r, std::span<double> z) const override {
    for (std::size_t i = 0; i < inverse_.size(); ++i) {
      const auto first = static_cast<std::size_t>(pattern_->dof_start[i]);
      const auto dim = inverse_[i].rows();
      Eigen::Map<Eigen::VectorXd>(&z[first], dim) =
          inverse_[i] * Eigen::Map<const Eigen::VectorXd>(&r[first], dim);
    }
  }

 private:
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::shared_ptr<const taut::BlockPattern> pattern_;
  std::vector<Block> inverse_;
};

int solves = 0;

// A solver has one function to write; this one lets Taut's direct method do the work.
class Counting : public taut::ConstrainedSolver {
 public:
  explicit Counting(const taut::SolverOptions& options)
      : ConstrainedSolver(options), direct_(taut::make_solver({.name = "block_cholesky"})) {}

 protected:
  void run(const taut::LinearSystem& system, std::span<double> x,
           taut::SolveSummary& summary) override {
    ++solves;
    run_other(*direct_, system, x, summary);
  }

 private:
  std::unique_ptr<taut::ConstrainedSolver> direct_;
};

double lowest_with(const char* solver) {
  taut::World world;
  const auto sheet = world.add_cloth(
      {.mesh = taut::make_grid({.nu = 15, .nv = 15}), .density = 0.15, .grid = {15, 15}});
  world.pin(sheet, {210, 224});
  taut::Simulation simulation(std::move(world), {.solver = {.name = solver, .tolerance = 1e-9}});
  for (int k = 0; k < 50; ++k)
    if (const auto report = simulation.step(5e-3); !report.ok())
      return std::puts(report.message().c_str()), NAN;
  return simulation.positions(sheet)[7].z();
}

}  // namespace

int main() {
  taut::register_preconditioner("jacobi",
                                [](const auto&) { return std::make_unique<BlockJacobi>(); });
  taut::register_solver("counting", [](const auto& o) { return std::make_unique<Counting>(o); });
  const double reference = lowest_with("core_fast"), own = lowest_with("upcg:jacobi"),
               counted = lowest_with("counting");
  std::printf(
      "same motion: %s, solves counted: %d\n",
      std::abs(own - reference) < 1e-6 && std::abs(counted - reference) < 1e-6 ? "yes" : "no",
      solves);
}
