#include "bench/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/median.h"
#include "bench/quiet.h"
#include "taut/base/error.h"
#include "taut/base/timer.h"
#include "taut/constraint/reduction.h"
#include "taut/core/core_bound.h"
#include "taut/solve/reference.h"
#include "taut/solve/solver_registry.h"

namespace taut::app {

namespace {

// Some show their answer only: PARDISO's CG needs the factor of an earlier step, and auto decides
// by its own stop rule. So their iterations cannot be cut at a wanted error.
bool method_hides_iterates(const Method& method) {
  return !solver_traits(method.solver).shows_iterates;
}

// Analysed once per topology: that is what is measured.
bool keeps_analysis(const Method& method) { return solver_traits(method.solver).keeps_analysis; }

// One method's solver and its samples.
struct Bench {
  Cell cell;
  std::unique_ptr<ConstrainedSolver> solver;
  std::map<int, double> totals, steps;       // ms, by step
  int errors = 0;                            // steps at which the error was measured
  double last_error = 0.0;                   // in the A-norm, of the step measured last
  std::map<int, double> equal_error_totals;  // by step
};

// An integrator's own assembly of the same states.
struct Assembly {
  IntegratorKind kind;
  std::unique_ptr<Stepper> stepper;
};

class Campaign {
 public:
  Campaign(Simulation& simulation, const std::vector<Method>& methods,
           const MeasureOptions& options)
      : simulation_(simulation), options_(options) {
    for (const Method& method : methods) {
      Bench bench;
      bench.cell.method = method;
      bench.solver = make_solver(solver_options(method, options_.tolerance, 0));
      benches_.push_back(std::move(bench));
      stepper_of(method.integrator);
    }
  }

  void measure_step() {
    const State& state = simulation_.state();
    const double h = simulation_.scene().time.step;
    for (Assembly& assembly : assemblies_) {
      Stepper& stepper = *assembly.stepper;
      stepper.begin(state, h);
      const double rho = stepper.remainder_ratio();
      for (Bench& bench : benches_)
        if (bench.cell.method.integrator == assembly.kind && step_ % bench.cell.method.every == 0)
          measure_method(bench, stepper, rho);
      if (options_.equal_error_every > 0 && step_ % options_.equal_error_every == 0)
        for (Bench& bench : benches_)
          if (bench.cell.method.integrator == assembly.kind && bench.totals.count(step_))
            measure_equal_error(bench, stepper);
    }
    ++step_;
  }

  std::vector<Cell> cells() {
    std::vector<Cell> result;
    for (Bench& bench : benches_) {
      Cell& c = bench.cell;
      for (double* mean : {&c.iterations, &c.assemble_ms, &c.setup_ms, &c.solve_ms,
                           &c.relative_residual, &c.spmv_ms})
        *mean /= std::max(1, c.steps);
      c.anorm_error /= std::max(1, bench.errors);
      if (c.bound_iterations > 0) c.bound_iterations /= c.steps;
      const int equal = static_cast<int>(bench.equal_error_totals.size());
      if (equal > 0) c.equal_error_ms /= equal, c.equal_error_iterations /= equal;
      if (const Bench* reference = reference_of(c.method.integrator)) {
        std::vector<double> ratios, step_ratios, equal_ratios;
        for (const auto& [step, total] : bench.totals)
          ratios.push_back(total / reference->totals.at(step));
        for (const auto& [step, total] : bench.steps)
          step_ratios.push_back(total / reference->steps.at(step));
        for (const auto& [step, total] : bench.equal_error_totals)
          equal_ratios.push_back(total / reference->totals.at(step));
        c.ratio = median(ratios), c.step_ratio = median(step_ratios),
        c.equal_error_ratio = median(equal_ratios);
      }
      result.push_back(c);
    }
    return result;
  }

 private:
  static SolverOptions solver_options(const Method& method, double tolerance, int max_iterations) {
    SolverOptions options;
    options.name = method.solver;
    options.tolerance = tolerance;
    options.max_iterations = max_iterations;
    options.reordering = method.reordering;
    options.reuse_analysis = false;  // the paper analyses in every step
    return options;
  }

  Stepper& stepper_of(IntegratorKind kind) {
    for (Assembly& assembly : assemblies_)
      if (assembly.kind == kind) return *assembly.stepper;
    const ClothModel& cloth = simulation_.cloth();
    assemblies_.push_back(
        {kind, std::make_unique<Stepper>(cloth.nodes(), cloth.force_models(), cloth.external(),
                                         kind, SolverOptions{})});
    return *assemblies_.back().stepper;
  }

  const Bench* reference_of(IntegratorKind kind) const {
    for (const Bench& bench : benches_)
      if (bench.cell.method.integrator == kind && bench.cell.method.solver == options_.reference)
        return &bench;
    return nullptr;
  }

  void measure_method(Bench& bench, Stepper& stepper, double rho) {
    Cell& c = bench.cell;
    if (c.steps == 0 && keeps_analysis(c.method))
      stepper.solve(simulation_.constraints(), simulation_.contact().impulses(), *bench.solver);
    wait_for_quiet(stepper.matrix());
    const SolveSummary s =
        stepper.solve(simulation_.constraints(), simulation_.contact().impulses(), *bench.solver);
    const LinearSystem system = stepper.system();
    const auto x = flat(stepper.unknown());
    // The reference of this step, found once for all methods of this integrator. It takes as long
    // as a direct method.
    const bool with_error =
        options_.equal_error_every == 0 || step_ % options_.equal_error_every == 0;
    if (with_error && (reference_step_ != step_ || reference_kind_ != c.method.integrator)) {
      reference_ = reference_solution(system);
      reference_step_ = step_, reference_kind_ = c.method.integrator;
    }
    c.steps += 1;
    c.failures += !s.status.ok();
    c.precision = s.precision;
    c.fallbacks += s.fallbacks;
    c.factorisations += method_hides_iterates(c.method) && s.iterations == 0;
    c.iterations += s.iterations;
    c.assemble_ms += stepper.assemble_ms();
    const double setup = s.reduce_ms + s.order_ms + s.factor_ms;
    c.setup_ms += setup;
    c.solve_ms += s.solve_ms;
    c.relative_residual += s.relative_residual;
    if (with_error) {
      bench.last_error = anorm_error(system, x, reference_);
      c.anorm_error += bench.last_error;
      ++bench.errors;
    }
    c.memory_MB = std::max(c.memory_MB, s.memory_bytes / 1e6);
    c.spmv_ms += product_ms(stepper.matrix());
    c.unknowns = system.constraints->free_dofs();
    c.held_nodes =
        static_cast<Index>(std::ranges::count(system.constraints->ndofs(), std::int8_t{0}));
    c.nonzeros = static_cast<double>(nonzeros_of(c.method, stepper, *system.constraints));
    if (solver_traits(c.method.solver).bounds_iterations)
      c.bound_iterations = std::max(0.0, c.bound_iterations) +
                           core_iteration_bound(rho, s.start_value, options_.tolerance);
    bench.totals[step_] = s.total_ms();
    bench.steps[step_] = s.total_ms() + stepper.assemble_ms();
  }

  static Offset nonzeros_of(const Method& method, const Stepper& stepper,
                            const ConstraintSet& constraints) {
    if (!method.solver.starts_with("upcg")) return stepper.matrix().pattern->value_count();
    Offset count = 0;
    const BlockPattern& p = *stepper.matrix().pattern;
    for (Index i = 0; i < p.rows(); ++i)
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k)
        count += constraints.ndof(i) * constraints.ndof(p.column[k]);
    return count;
  }

  double product_ms(const BlockCsr& a) {
    std::vector<double> x(static_cast<std::size_t>(a.dofs()), 1.0), y(x.size());
    Timer timer;
    multiply(a, x, y);
    return timer.milliseconds();
  }

  // Finds how many iterations the method needs to the wanted A-norm error, then times just these.
  void measure_equal_error(Bench& bench, Stepper& stepper) {
    const Method& method = bench.cell.method;
    const LinearSystem system = stepper.system();
    if (method_hides_iterates(method) && bench.last_error > options_.equal_error) return;
    // direct: what was measured is exact
    if (bench.cell.iterations == 0.0 || method_hides_iterates(method)) {
      bench.equal_error_totals[step_] = bench.totals.at(step_);
      bench.cell.equal_error_ms += bench.totals.at(step_);
      return;
    }
    int needed = -1;
    std::vector<double> x(system.rhs.size());
    const double first_tolerance =
        options_.tolerance * (bench.last_error > options_.equal_error ? 1e-2 : 1.0);
    for (double tolerance = first_tolerance; needed < 0 && tolerance > 1e-13; tolerance *= 1e-2) {
      const auto search = make_solver(solver_options(method, tolerance, 0));
      search->observer = [&](int iteration, double, std::span<const double> iterate) {
        // Where there are many, the error is looked at every fifth: it takes a product.
        if (iteration > 50 && iteration % 5 != 0) return;
        if (needed < 0 && anorm_error(system, iterate, reference_) <= options_.equal_error)
          needed = iteration;
      };
      search->solve(system, x);
    }
    if (needed < 0) return;
    const auto timed = make_solver(solver_options(method, 0.0, needed));
    if (keeps_analysis(method)) timed->solve(system, x);
    wait_for_quiet(*system.matrix);
    const SolveSummary s = timed->solve(system, x);
    bench.equal_error_totals[step_] = s.total_ms();
    bench.cell.equal_error_ms += s.total_ms();
    bench.cell.equal_error_iterations += needed;
  }

  Simulation& simulation_;
  MeasureOptions options_;
  std::vector<Bench> benches_;
  std::vector<Assembly> assemblies_;
  std::vector<double> reference_;
  int step_ = 0, reference_step_ = -1;
  IntegratorKind reference_kind_ = IntegratorKind::semi_implicit_euler;
};

}  // namespace

std::vector<Cell> measure(Simulation& simulation, const std::vector<Method>& methods,
                          const MeasureOptions& options,
                          const std::function<bool(const Simulation&, const StepRecord&)>& start) {
  const int most_steps = simulation.scene().time.frames * simulation.scene().time.steps_per_frame;
  StepRecord record;
  const auto advance = [&] {
    if (const Status status = simulation.step(record); !status.ok())
      throw InputError(status.message);
  };
  do {
    if (simulation.steps_done() >= most_steps)
      throw InputError(
          fmt::format("the scene '{}' never reached the states to measure in its {} steps",
                      simulation.scene().title, most_steps));
    advance();
  } while (!start(simulation, record));
  Campaign campaign(simulation, methods, options);
  simulation.on_solved = [&](Simulation&, const SolveSummary&) { campaign.measure_step(); };
  for (int step = 0; step < options.steps; ++step) advance();
  simulation.on_solved = nullptr;
  return campaign.cells();
}

}  // namespace taut::app
