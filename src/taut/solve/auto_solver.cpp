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

// In the order of Kind.
constexpr const char* names[] = {
    auto_core_method, auto_core_method, auto_core_method, "upcg:projected_block_diagonal",
    "upcg:ic0_core",  "upcg:ic0",       "block_cholesky"};
constexpr std::size_t kinds = std::size(names);

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
constexpr double memory_version = 7;
constexpr double most_other_cores = 64;  // in a memory that is not damaged

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

const char* AutoSolver::name_of(Kind kind) { return names[static_cast<std::size_t>(kind)]; }

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

std::vector<AutoSolver::Method> AutoSolver::methods(std::size_t other_cores) {
  std::vector<Method> list;
  for (std::size_t k = 0; k < kinds; ++k) {
    const Kind kind = static_cast<Kind>(k);
    const std::size_t count = kind == Kind::other_core ? other_cores : 1;
    for (std::size_t other = 0; other < count; ++other) list.push_back({kind, other});
  }
  return list;
}

void AutoSolver::know_cores(std::size_t other_cores) {
  const std::size_t known = methods_.size() - (kinds - 1);
  if (other_cores <= known) return;
  std::vector<Method> list = methods(other_cores);
  for (Method& method : methods_)
    *std::ranges::find_if(list, [&](const Method& m) {
      return m.kind == method.kind && m.other == method.other;
    }) = std::move(method);
  methods_ = std::move(list);
}

const AutoSolver::Method& AutoSolver::method(Kind kind) const {
  return *std::ranges::find(methods_, kind, &Method::kind);
}

ConstrainedSolver& AutoSolver::solver(Method& method) {
  if (!method.solver) {
    SolverOptions options = options_;
    options.name = name_of(method.kind);
    method.solver = make_solver(options);
  }
  return *method.solver;
}

bool AutoSolver::available(const Method& method, const SystemSize& size) {
  if (method.kind == Kind::other_core) return core_nonzeros(method, size) > 0.0;
  return method.kind != Kind::full_core || size.core_nonzeros < nearly_all * size.nonzeros;
}

double AutoSolver::core_nonzeros(const Method& method, const SystemSize& size) {
  if (method.kind != Kind::other_core)
    return method.kind == Kind::own_core ? size.core_nonzeros : size.nonzeros;
  return method.other < size.other_core_nonzeros.size() ? size.other_core_nonzeros[method.other]
                                                        : 0.0;
}

MethodWork AutoSolver::work(const Method& method, const SystemSize& size) {
  const Record& r = method.record;
  FactorSize factor{r.factor_nonzeros, r.factor_flops, r.left_out_nonzeros};
  if (!factor.known()) factor = estimate_factor(size, core_nonzeros(method, size));
  switch (method.kind) {
    case Kind::block_diagonal:
      return block_diagonal_work(size);
    case Kind::ic0_core:
      return incomplete_work(size, size.core_nonzeros, r.preparations);
    case Kind::ic0:
      return incomplete_work(size, size.nonzeros, r.preparations);
    case Kind::direct:
      return direct_work(factor);
    default:
      return core_work(size, factor, r.preparations);
  }
}

double AutoSolver::expected_work(const Method& method, const SystemSize& size) {
  return work(method, size).total(std::max(0.0, method.record.iterations));
}

int AutoSolver::budget(const Method& method, const SystemSize& size, double limit) {
  const MethodWork w = work(method, size);
  const double iterations = w.per_iteration > 0.0 ? (limit - w.setup) / w.per_iteration : 0.0;
  return static_cast<int>(
      std::clamp(std::floor(iterations), static_cast<double>(least_trial), 1e6));
}

AutoSolver::Method& AutoSolver::choose(const SystemSize& size) {
  // Untried and not to be tried: it has failed.
  Method* best =
      !own_core().tried() && own_core().record.next_trial > solves_ ? &direct() : &own_core();
  for (Method& method : methods_)
    if (method.tried() && available(method, size) &&
        expected_work(method, size) < expected_work(*best, size))
      best = &method;
  return *best;
}

// Of a method that has not been tried.
double AutoSolver::least_iterations(const Method& of, const Solve& solve) const {
  if (has_core(of.kind)) return 1.0;
  const double rho = solve.original.core.rho;
  double least = least_trial;
  if (of.kind == Kind::block_diagonal) {
    const double condition = block_diagonal_condition(*solve.original.matrix);
    least = block_diagonal_share * 0.5 * std::sqrt(condition) * std::log(2.0 / options_.tolerance);
  } else if (of.kind == Kind::ic0 && method(Kind::ic0_core).tried() && rho >= 0.0) {
    least = method(Kind::ic0_core).record.iterations / std::sqrt(1.0 + rho);
  }
  return std::max<double>(least_trial, least);
}

AutoSolver::Method& AutoSolver::rival_of(Method& chosen, const Solve& solve) {
  const SystemSize& size = solve.size;
  if (!chosen.tried()) return chosen;
  const double to_beat = expected_work(chosen, size);
  Method* rival = &chosen;
  double least = to_beat;
  for (Method& method : methods_) {
    if (&method == &chosen || !available(method, size) || method.record.next_trial > solves_)
      continue;
    const MethodWork w = work(method, size);
    const double hoped = method.kind == Kind::direct
                             ? w.setup
                             : w.total(method.tried() ? 0.5 * method.record.iterations
                                                      : least_iterations(method, solve));
    if (!method.tried() && hoped < to_beat) return method;
    // Whether there is hope costs a look at the matrix, but for a core.
    if (!method.tried() && !has_core(method.kind))
      method.record.next_trial = solves_ + shortest_patience;
    if (hoped < least) rival = &method, least = hoped;
  }
  return *rival;
}

void AutoSolver::run(const LinearSystem& system, std::span<double> x, SolveSummary& summary) {
  ++solves_;
  know_cores(system.other_cores.size());
  Solve solve{system, system, x, summary, size_of(system), true};
  Method& chosen = choose(solve.size);
  Method& rival = rival_of(chosen, solve);
  if (&rival != &chosen) {
    const bool won = attempt(rival, budget(rival, solve.size, expected_work(chosen, solve.size)),
                             solve) == Attempt::solved;
    note_trial(rival, won);
    if (won) return;
  }
  if (chosen.kind != Kind::own_core && chosen.kind != Kind::direct) {
    const double limit = give_up_at * expected_work(own_core(), solve.size);
    if (attempt(chosen, budget(chosen, solve.size, limit), solve) == Attempt::solved) return;
    note_trial(chosen, false);
  } else if (chosen.kind == Kind::direct) {
    if (attempt(direct(), 0, solve) == Attempt::solved) return;
  }
  // A core that leaves out too much, or everything, has no useful bound.
  const double limit = give_up_at * expected_work(direct(), solve.size);
  if (attempt(own_core(), budget(own_core(), solve.size, limit), solve) != Attempt::solved)
    attempt(direct(), 0, solve);
}

double AutoSolver::allowed_condition(const LinearSystem& system) {
  return system.core.rho >= 0.0 ? system.core.condition() : core_condition;
}

double AutoSolver::first_condition(Kind kind, const LinearSystem& system) {
  return has_core(kind) ? allowed_condition(system) : block_diagonal_condition(*system.matrix);
}

double AutoSolver::tolerance_for(const Method& method, const LinearSystem& system) const {
  const double factor =
      method.kind == Kind::own_core
          ? 1.0
          : std::min(1.0, std::sqrt(allowed_condition(system) / method.record.condition));
  return std::max(1e-14, options_.tolerance * factor);
}

Core AutoSolver::full_core(const BlockCsr& a) {
  all_blocks_.assign(static_cast<std::size_t>(a.pattern->blocks()), 1);
  return {"all", all_blocks_, 0.0};
}

AutoSolver::Attempt AutoSolver::attempt(Method& method, int most_iterations, Solve& solve) {
  Record& r = method.record;
  const char* name = name_of(method.kind);
  // Few iterations would not show how bad it is.
  if (is_incomplete(method.kind) && r.condition == 0.0)
    r.condition = std::min(worst_condition, first_condition(method.kind, solve.original));
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
  if (method.kind == Kind::other_core) system.core = system.other_cores[method.other];
  if (method.kind == Kind::full_core) system.core = full_core(*system.matrix);
  run_other(with, system, solve.x, s);
  if (s.status.ok() && !all_finite(solve.x))
    s.status = {Outcome::not_finite, "the solution holds NaN or infinity"};
  learn(method, s, record, tolerance, solve);

  const double error = s.error_bound >= 0.0 ? s.error_bound : tolerance * std::sqrt(r.condition);
  const bool loose =
      is_incomplete(method.kind) &&
      error > loosest * options_.tolerance * std::sqrt(allowed_condition(solve.original));
  const Outcome outcome = s.status.outcome;
  const bool solved = s.status.ok() && !loose;
  s.method = name;
  if (!solved) {
    const char* end = loose && s.status.ok()               ? "not accurate enough"
                      : outcome == Outcome::max_iterations ? "given up"
                                                           : "failed";
    s.remark = fmt::format("{} {} after {} iterations", name, end, s.iterations);
    // The iterate so far is where the next method begins.
    guess_.assign(solve.x.begin(), solve.x.end());
    if (all_finite(guess_)) solve.system.guess = guess_, solve.system.guess_is_iterate = true;
    solve.first = false;
  }
  add_attempt(std::move(s), solve.summary);
  if (solved) {
    last_solved_ = method.kind;
    return Attempt::solved;
  }
  if (outcome == Outcome::converged || outcome == Outcome::max_iterations) return Attempt::given_up;
  ++solve.summary.fallbacks;
  return Attempt::failed;
}

void AutoSolver::learn(Method& method, const SolveSummary& s, const CgCoefficients& record,
                       double tolerance, Solve& solve) {
  Record& r = method.record;
  // In double precision from the start it costs twice as much: half a preparation more (core_work).
  const bool at_once_in_double =
      has_core(method.kind) && s.fallbacks == 0 && std::string_view(s.precision) == "double";
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
  if (is_incomplete(method.kind)) {
    double seen = r.condition;
    if (has_core(method.kind)) {
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

void AutoSolver::note_trial(Method& method, bool won) {
  Record& r = method.record;
  r.patience = won ? shortest_patience : std::min(longest_patience, 2.0 * r.patience);
  r.next_trial = std::max(r.next_trial, solves_ + r.patience);
}

std::vector<double> AutoSolver::memory() const {
  std::vector<double> list{memory_version, solves_,
                           static_cast<double>(methods_.size() - (kinds - 1))};
  for (const Method& method : methods_) {
    const Record& r = method.record;
    list.insert(list.end(), {r.iterations, r.condition, r.next_trial, r.patience, r.factor_nonzeros,
                             r.factor_flops, r.left_out_nonzeros, r.preparations});
    const std::vector<double> inner =
        method.solver ? method.solver->memory() : std::vector<double>{};
    list.push_back(static_cast<double>(inner.size()));
    list.insert(list.end(), inner.begin(), inner.end());
  }
  return list;
}

void AutoSolver::restore_memory(std::span<const double> memory) {
  if (memory.empty()) {
    for (Method& method : methods_) method.record = {};
    solves_ = 0.0;
    return;
  }
  std::size_t at = 0;
  const auto next = [&] {
    if (at >= memory.size())
      throw InputError("the stored memory of the solver 'auto' is too short");
    return memory[at++];
  };
  // Of a list, at most `most` long.
  const auto next_count = [&](double most) {
    const double count = next();
    if (!(count >= 0.0 && count <= most))
      throw InputError("the stored memory of the solver 'auto' is damaged");
    return static_cast<std::size_t>(count);
  };
  if (next() != memory_version)
    throw InputError("the stored memory of a solver does not belong to 'auto'");
  solves_ = next();
  methods_ = methods(next_count(most_other_cores));
  for (Method& method : methods_) {
    Record& r = method.record;
    for (double* value :
         {&r.iterations, &r.condition, &r.next_trial, &r.patience, &r.factor_nonzeros,
          &r.factor_flops, &r.left_out_nonzeros, &r.preparations})
      *value = next();
    std::vector<double> inner(next_count(static_cast<double>(memory.size())));
    for (double& value : inner) value = next();
    if (!inner.empty()) solver(method).restore_memory(inner);
  }
}

}  // namespace taut
