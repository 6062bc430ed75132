#include "taut/solve/auto_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/base/error.h"
#include "taut/core/core_bound.h"
#include "taut/linalg/lanczos.h"
#include "taut/linalg/vector_ops.h"

namespace taut {

namespace {

constexpr const char* names[] = {auto_core_method,
                                 auto_core_method,
                                 auto_core_method,
                                 auto_core_method,
                                 "upcg:projected_block_diagonal",
                                 "upcg:ic0_core",
                                 "upcg:ic0",
                                 "block_cholesky"};

constexpr double shortest_patience = 32, longest_patience = 256;  // solves
constexpr double bar_after_failure = 64;                          // solves
// iterations a method has to show what it can
constexpr int least_trial = 3;
// of the iterations that its condition allows, at least
constexpr double block_diagonal_share = 0.25;
constexpr double give_up_at = 2.0;  // times the work of corePCG
// 2 (1 + ρ) where ρ is not known: that of the chosen core
constexpr double core_condition = 18.0;
// times the error that corePCG may leave
constexpr double loosest = 3.0;
constexpr double worst_condition = 1e12;  // of what these methods can solve
// of A's blocks in the core: the full core is the same
constexpr double nearly_all = 0.98;
constexpr double memory_version = 6;

// Times are sums, the rest is the last attempt's.
void add_attempt(SolveSummary&& attempt, SolveSummary& sum) {
  attempt.solver = sum.solver;
  attempt.remark =
      sum.remark + (sum.remark.empty() || attempt.remark.empty() ? "" : "; ") + attempt.remark;
  attempt.reduce_ms += sum.reduce_ms;
  attempt.order_ms += sum.order_ms;
  attempt.factor_ms += sum.factor_ms;
  attempt.solve_ms += sum.solve_ms;
  attempt.memory_bytes = std::max(attempt.memory_bytes, sum.memory_bytes);
  attempt.fallbacks += sum.fallbacks;
  sum = std::move(attempt);
}

}  // namespace

// What the attempts at one system share.
struct AutoSolver::Solve {
  const LinearSystem& original;
  LinearSystem system;  // with the last attempt's iterate as its guess
  std::span<double> x;
  SolveSummary& summary;
  SystemSize size;
  bool first = true;  // the guess is still the system's own
};

AutoSolver::AutoSolver(SolverOptions options) : ConstrainedSolver(std::move(options)) {}
AutoSolver::~AutoSolver() = default;

ConstrainedSolver& AutoSolver::solver(Method method) {
  if (!solvers_[method]) {
    SolverOptions options = options_;
    options.name = names[method];
    solvers_[method] = make_solver(options);
  }
  return *solvers_[method];
}

bool AutoSolver::available(Method method, const SystemSize& size) {
  if (method == stretch_core) return size.stretch_core_nonzeros > 0.0;
  if (method == unbent_core) return size.unbent_core_nonzeros > 0.0;
  return method != full_core || size.core_nonzeros < nearly_all * size.nonzeros;
}

MethodWork AutoSolver::work(Method method, const SystemSize& size) const {
  const Record& r = records_[method];
  const FactorSize known{r.factor_nonzeros, r.factor_flops, r.left_out_nonzeros};
  switch (method) {
    case core:
      return core_work(size, known.known() ? known : estimate_factor(size, size.core_nonzeros),
                       r.preparations);
    case stretch_core:
      return core_work(size,
                       known.known() ? known : estimate_factor(size, size.stretch_core_nonzeros),
                       r.preparations);
    case unbent_core:
      return core_work(size,
                       known.known() ? known : estimate_factor(size, size.unbent_core_nonzeros),
                       r.preparations);
    case full_core:
      return core_work(size, known.known() ? known : estimate_factor(size, size.nonzeros),
                       r.preparations);
    case block_diagonal:
      return block_diagonal_work(size);
    case ic0_core:
      return incomplete_work(size, size.core_nonzeros, records_[method].preparations);
    case ic0:
      return incomplete_work(size, size.nonzeros, records_[method].preparations);
    default:
      return direct_work(known.known() ? known : estimate_factor(size, size.nonzeros));
  }
}

double AutoSolver::expected_work(Method method, const SystemSize& size) const {
  return work(method, size).total(std::max(0.0, records_[method].iterations));
}

int AutoSolver::budget(Method method, const SystemSize& size, double limit) const {
  const MethodWork w = work(method, size);
  const double iterations = w.per_iteration > 0.0 ? (limit - w.setup) / w.per_iteration : 0.0;
  return static_cast<int>(
      std::clamp(std::floor(iterations), static_cast<double>(least_trial), 1e6));
}

AutoSolver::Method AutoSolver::choose(const SystemSize& size) const {
  // Untried and not to be tried: it has failed.
  Method best = !tried(core) && records_[core].next_trial > solves_ ? direct : core;
  for (int m = 0; m < method_count; ++m)
    if (const Method method = static_cast<Method>(m);
        tried(method) && available(method, size) &&
        expected_work(method, size) < expected_work(best, size))
      best = method;
  return best;
}

// Of a method that has not been tried.
double AutoSolver::least_iterations(Method method, const Solve& solve) const {
  if (has_core(method)) return 1.0;
  double least = least_trial;
  if (method == block_diagonal) {
    const double condition = block_diagonal_condition(*solve.original.matrix);
    least = block_diagonal_share * 0.5 * std::sqrt(condition) * std::log(2.0 / options_.tolerance);
  } else if (method == ic0 && tried(ic0_core) && solve.original.rho >= 0.0) {
    least = records_[ic0_core].iterations / std::sqrt(1.0 + solve.original.rho);
  }
  return std::max<double>(least_trial, least);
}

AutoSolver::Method AutoSolver::rival_of(Method chosen, const Solve& solve) {
  const SystemSize& size = solve.size;
  if (!tried(chosen)) return chosen;
  const double to_beat = expected_work(chosen, size);
  Method rival = chosen;
  double least = to_beat;
  for (int m = 0; m < method_count; ++m) {
    const Method method = static_cast<Method>(m);
    if (method == chosen || !available(method, size) || records_[method].next_trial > solves_)
      continue;
    const MethodWork w = work(method, size);
    const double hoped = method == direct
                             ? w.setup
                             : w.total(tried(method) ? 0.5 * records_[method].iterations
                                                     : least_iterations(method, solve));
    if (!tried(method) && hoped < to_beat) return method;
    // Whether there is hope costs a look at the matrix, but for a core.
    if (!tried(method) && !has_core(method))
      records_[method].next_trial = solves_ + shortest_patience;
    if (hoped < least) rival = method, least = hoped;
  }
  return rival;
}

void AutoSolver::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  ++solves_;
  Solve solve{system, system, x, summary, size_of(system), true};
  const Method chosen = choose(solve.size), rival = rival_of(chosen, solve);
  if (rival != chosen) {
    const bool won = attempt(rival, budget(rival, solve.size, expected_work(chosen, solve.size)),
                             solve) == Attempt::solved;
    note_trial(rival, won);
    if (won) return;
  }
  if (chosen != core && chosen != direct) {
    if (attempt(chosen, budget(chosen, solve.size, give_up_at * expected_work(core, solve.size)),
                solve) == Attempt::solved)
      return;
    note_trial(chosen, false);
  } else if (chosen == direct) {
    if (attempt(direct, 0, solve) == Attempt::solved) return;
  }
  // A core that leaves out too much, or everything, has no useful bound.
  if (attempt(core, budget(core, solve.size, give_up_at * expected_work(direct, solve.size)),
              solve) != Attempt::solved)
    attempt(direct, 0, solve);
}

double AutoSolver::allowed_condition(const LinearSystem& system) {
  return system.rho >= 0.0 ? 2.0 * (1.0 + system.rho) : core_condition;
}

double AutoSolver::first_condition(Method method, const LinearSystem& system) {
  return has_core(method) ? allowed_condition(system) : block_diagonal_condition(*system.matrix);
}

double AutoSolver::tolerance_for(Method method, const LinearSystem& system) const {
  const double factor =
      method == core
          ? 1.0
          : std::min(1.0, std::sqrt(allowed_condition(system) / records_[method].condition));
  return std::max(1e-14, options_.tolerance * factor);
}

std::span<const std::uint8_t> AutoSolver::all_blocks(const BlockCsr& a) {
  all_blocks_.assign(static_cast<std::size_t>(a.pattern->blocks()), 1);
  return all_blocks_;
}

AutoSolver::Attempt AutoSolver::attempt(Method method, int most_iterations, Solve& solve) {
  // Few iterations would not show how bad it is.
  if (is_incomplete(method) && records_[method].condition == 0.0)
    records_[method].condition = std::min(worst_condition, first_condition(method, solve.original));
  ConstrainedSolver& with = solver(method);
  const double tolerance = tolerance_for(method, solve.original);
  if (options_.max_iterations > 0)
    most_iterations = std::min(most_iterations, options_.max_iterations);
  with.set_limits(tolerance, most_iterations);
  CgCoefficients record;
  with.coefficients = &record;
  with.observer = observer;
  SolveSummary s;
  LinearSystem system = solve.system;
  const auto take = [&](const OtherCore& other, CoreUsed used) {
    system.core = other.mask, system.rho = other.rho, s.core = used;
  };
  if (method == stretch_core) take(system.stretch_core, CoreUsed::stretch);
  if (method == unbent_core) take(system.unbent_core, CoreUsed::unbent);
  if (method == full_core)
    system.core = all_blocks(*system.matrix), system.rho = 0.0, s.core = CoreUsed::all;
  run_other(with, system, solve.x, s);
  if (s.status.ok() && !all_finite(solve.x))
    s.status = {Outcome::not_finite, "the solution holds NaN or infinity"};
  learn(method, s, record, tolerance, solve);

  const double error =
      s.error_bound >= 0.0 ? s.error_bound : tolerance * std::sqrt(records_[method].condition);
  const bool loose =
      is_incomplete(method) &&
      error > loosest * options_.tolerance * std::sqrt(allowed_condition(solve.original));
  const Outcome outcome = s.status.outcome;
  const bool solved = s.status.ok() && !loose;
  s.method = names[method];
  if (!solved) {
    const char* end = loose && s.status.ok()               ? "not accurate enough"
                      : outcome == Outcome::max_iterations ? "given up"
                                                           : "failed";
    s.remark = fmt::format("{} {} after {} iterations", names[method], end, s.iterations);
    // The iterate so far is where the next method begins.
    guess_.assign(solve.x.begin(), solve.x.end());
    if (all_finite(guess_)) solve.system.guess = guess_, solve.system.guess_is_iterate = true;
    solve.first = false;
  }
  add_attempt(std::move(s), solve.summary);
  if (solved) {
    last_solved_ = method;
    return Attempt::solved;
  }
  if (outcome == Outcome::converged || outcome == Outcome::max_iterations) return Attempt::given_up;
  ++solve.summary.fallbacks;
  return Attempt::failed;
}

void AutoSolver::learn(Method method, const SolveSummary& s, const CgCoefficients& record,
                       double tolerance, Solve& solve) {
  Record& r = records_[method];
  // In double precision from the start it costs twice as much: half a preparation more (core_work).
  const bool at_once_in_double =
      has_core(method) && s.fallbacks == 0 && std::string_view(s.precision) == "double";
  r.preparations = s.preparations + s.fallbacks + (at_once_in_double ? 0.5 : 0.0);
  if (s.factor_nonzeros > 0.0) {
    r.factor_nonzeros = s.factor_nonzeros, r.factor_flops = s.factor_flops;
    r.left_out_nonzeros = std::max(0.0, s.left_out_nonzeros);
  }
  if (!s.status.ok() && s.status.outcome != Outcome::max_iterations) {
    r.iterations = -1.0;
    r.next_trial = solves_ + bar_after_failure;
    return;
  }
  if (is_incomplete(method)) {
    double seen = r.condition;
    if (has_core(method)) {
      if (s.error_bound > 0.0 && s.stop_value > 0.0)
        seen = std::pow(s.error_bound / s.stop_value, 2);
    } else if (record.alpha.size() > 1) {
      const SpectrumEnds ends = spectrum_ends(record);
      if (ends.smallest > 0.0) seen = ends.largest / ends.smallest;
    }
    // Few iterations see little of the spectrum: what was known before fades slowly.
    r.condition = std::max(seen, 0.7 * r.condition);
  }
  if (s.status.outcome == Outcome::max_iterations) {
    // What it would have taken at this rate, but no more than a few times what was seen.
    const double digits = std::log(s.start_value / s.stop_value),
                 missing = std::log(s.stop_value / tolerance);
    const double further = digits > 0.0 ? std::clamp(missing / digits, 0.5, 8.0) : 8.0;
    r.iterations = std::max(r.iterations, (1.0 + further) * s.iterations + 1.0);
  } else if (solve.first || r.iterations < 0.0) {
    // What the next solve will need, if the tolerance for it is another by now.
    const double digits = std::log(2.0 / tolerance),
                 next_digits = std::log(2.0 / tolerance_for(method, solve.original));
    r.iterations = s.iterations * next_digits / digits;
  }
}

void AutoSolver::note_trial(Method method, bool won) {
  Record& r = records_[method];
  r.patience = won ? shortest_patience : std::min(longest_patience, 2.0 * r.patience);
  r.next_trial = std::max(r.next_trial, solves_ + r.patience);
}

std::vector<double> AutoSolver::memory() const {
  std::vector<double> list{memory_version, solves_};
  for (int m = 0; m < method_count; ++m) {
    const Record& r = records_[static_cast<std::size_t>(m)];
    list.insert(list.end(), {r.iterations, r.condition, r.next_trial, r.patience, r.factor_nonzeros,
                             r.factor_flops, r.left_out_nonzeros, r.preparations});
    const std::vector<double> inner = solvers_[static_cast<std::size_t>(m)]
                                          ? solvers_[static_cast<std::size_t>(m)]->memory()
                                          : std::vector<double>{};
    list.push_back(static_cast<double>(inner.size()));
    list.insert(list.end(), inner.begin(), inner.end());
  }
  return list;
}

void AutoSolver::restore_memory(std::span<const double> memory) {
  if (memory.empty()) {
    records_ = {};
    solves_ = 0.0;
    return;
  }
  std::size_t at = 0;
  const auto next = [&] {
    if (at >= memory.size())
      throw InputError("the stored memory of the solver 'auto' is too short");
    return memory[at++];
  };
  if (next() != memory_version)
    throw InputError("the stored memory of a solver does not belong to 'auto'");
  solves_ = next();
  for (int m = 0; m < method_count; ++m) {
    Record& r = records_[static_cast<std::size_t>(m)];
    for (double* value :
         {&r.iterations, &r.condition, &r.next_trial, &r.patience, &r.factor_nonzeros,
          &r.factor_flops, &r.left_out_nonzeros, &r.preparations})
      *value = next();
    const double count = next();
    if (!(count >= 0.0 && count <= static_cast<double>(memory.size() - at)))
      throw InputError("the stored memory of the solver 'auto' is damaged");
    std::vector<double> inner(static_cast<std::size_t>(count));
    for (double& value : inner) value = next();
    if (!inner.empty()) solver(static_cast<Method>(m)).restore_memory(inner);
  }
}

}  // namespace taut
