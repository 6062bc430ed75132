// Solvers and preconditioners of a user's program, by name (solve/solver_registry.h). "own" is
// registered in own_methods.cpp, before the tests are listed.

#include "taut/solve/solver_registry.h"

#include <gtest/gtest.h>

#include <thread>

#include "solve/constrained_case.h"
#include "taut/base/error.h"
#include "taut/linalg/eigen_cholesky.h"
#include "taut/linalg/sparse_cholesky.h"

namespace taut::test {
namespace {

std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "done";
}

bool says(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos;
}

std::ptrdiff_t place(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) - names.begin();
}

struct Iterates {
  std::vector<Eigen::VectorXd> x;
  SolveSummary summary;
};

Iterates iterates_of(const ConstrainedCase& c, const std::string& name, double tolerance = 1e-6) {
  Iterates result;
  const auto solver = make_solver(solver_options(name, tolerance));
  solver->observer = [&](int, double, std::span<const double> x) {
    result.x.push_back(as_eigen(x));
  };
  std::vector<double> x(c.b.size());
  result.summary = solver->solve(c.system(), x);
  EXPECT_TRUE(result.summary.status.ok()) << name << ": " << result.summary.status.message;
  return result;
}

void expect_same_iterates(const ConstrainedCase& c, const std::string& one,
                          const std::string& other) {
  SCOPED_TRACE(one + ", " + other);
  const Iterates a = iterates_of(c, one), b = iterates_of(c, other);
  ASSERT_EQ(a.x.size(), b.x.size());
  EXPECT_GT(a.x.size(), 3u);
  for (std::size_t k = 0; k < a.x.size(); ++k)
    EXPECT_LT((a.x[k] - b.x[k]).norm(), 1e-9 * b.x[k].norm()) << k;
}

ConstrainedCase stiff_case(std::uint32_t seed) {
  Random random(seed);
  return random_case(random, {.nodes = 60, .margin = 1e-3});
}

TEST(Registry, ListsWhatTautHasInItsOrder) {
  std::vector<std::string> expected{"mpcg",
                                    "mpcg:diagonal",
                                    "mpcg:block_diagonal",
                                    "mpcg:projected_block_diagonal",
                                    "mpcg:ic0",
                                    "mpcg:ic0_core",
                                    "mpcg:ssor",
                                    "upcg",
                                    "upcg:diagonal",
                                    "upcg:block_diagonal",
                                    "upcg:reduced_diagonal",
                                    "upcg:projected_block_diagonal",
                                    "upcg:ic0",
                                    "upcg:ic0_core",
                                    "upcg:ssor",
                                    "upcg:amg",
                                    "ppcg",
                                    "ppcg:block_diagonal",
                                    "ppcg:ic0",
                                    "ppcg:ic0_core",
                                    "ppcg:ssor",
                                    "ppcg:amg",
                                    "eq10",
                                    "eq10:block_diagonal",
                                    "eq10:ilu0",
                                    "cholmod",
                                    "cholmod_reused_analysis",
                                    "pardiso",
                                    "pardiso_cgs",
                                    "eigen_ldlt",
                                    "block_cholesky",
                                    "core_fast",
                                    "core_pcg",
                                    "core_pcg:cholmod",
                                    "core_pcg:eigen",
                                    "core_pcg:block",
                                    "auto",
                                    "core_pcg:pardiso"};
  for (const std::string& name : expected) EXPECT_TRUE(is_solver_name(name)) << name;
  for (const std::string backend : {"cholmod", "pardiso"})
    if (!has_cholesky(backend))
      std::erase_if(expected, [&](const std::string& name) { return says(name, backend); });
  std::vector<std::string> names = solver_names();
  EXPECT_EQ(place(names, "upcg:own"), place(names, "upcg:amg") + 1);
  EXPECT_GT(place(names, "own"), place(names, "auto"));
  std::erase_if(names, [&](const std::string& n) { return std::ranges::count(expected, n) == 0; });
  EXPECT_EQ(names, expected);
}

TEST(Registry, TraitsAreThoseOfTheName) {
  EXPECT_TRUE(make_solver({.name = "own"})->traits().is_direct);
  EXPECT_FALSE(make_solver({.name = "upcg:own"})->traits().is_direct);
  for (const std::string& name : solver_names()) {
    const SolverTraits traits = solver_traits(name);
    const bool core = name.starts_with("core_");
    EXPECT_EQ(traits.bounds_iterations, core) << name;
    EXPECT_EQ(traits.needs_rho, core || name == "auto") << name;
    EXPECT_EQ(traits.needs_core, core || name == "auto" || name.ends_with("ic0_core")) << name;
    EXPECT_EQ(SolverOptions{.name = name}.chooses_core(), name == "auto") << name;
  }
  EXPECT_FALSE(solver_traits("nobody").is_direct);
}

TEST(Registry, TraitOfADirectMethodIsHeldAgainstIt) {
  // It answers 0 whatever is asked.
  class Lazy : public ConstrainedSolver {
   public:
    explicit Lazy(SolverOptions options) : ConstrainedSolver(std::move(options)) {}

   protected:
    void run(const LinearSystem& system, std::span<double> x, SolveSummary&) override {
      initial_guess(system, x);
    }
  };
  const auto factory = [](const SolverOptions& o) { return std::make_unique<Lazy>(o); };
  register_solver("lazy", factory);
  register_solver("lazy_direct", factory, {.is_direct = true});
  const ConstrainedCase c = stiff_case(1);
  std::vector<double> x(c.b.size());
  EXPECT_TRUE(make_solver({.name = "lazy"})->solve(c.system(), x).status.ok());
  EXPECT_EQ(make_solver({.name = "lazy_direct"})->solve(c.system(), x).status.outcome,
            Outcome::breakdown);
}

// The diagonal blocks of Ã and of S A S + d (I-S), which Taut has under another name.
TEST(Registry, OwnPreconditionerTakesTheSameStepsInEveryMethod) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed)
    for (const std::string method : {"mpcg:own", "upcg:own", "ppcg:own"})
      expect_same_iterates(stiff_case(seed), method, "upcg:projected_block_diagonal");
}

// M_p⁻¹ = D⁻¹ + v vᵀ couples all nodes and lets held ones move.
class Coupled : public Preconditioner {
 public:
  Status update(const BlockCsr& a) override {
    Random random(7);
    v_ = random.vector(a.dofs());
    return diagonal_.update(a);
  }
  void apply(std::span<const double> r, std::span<double> z) const override {
    diagonal_.apply(r, z);
    const double share = as_eigen(v_).dot(as_eigen(r)) / static_cast<double>(r.size());
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += share * v_[i];
  }

 private:
  DiagonalPreconditioner diagonal_;
  std::vector<double> v_;
};

TEST(Registry, HeldDirectionsStayWhateverThePreconditioner) {
  register_preconditioner("coupled",
                          [](const SolverOptions&) { return std::make_unique<Coupled>(); });
  const ConstrainedCase c = stiff_case(2);
  // Both work in full space with S M_p⁻¹ S.
  expect_same_iterates(c, "ppcg:coupled", "mpcg:coupled");
  for (const std::string& name : solver_names()) {
    if (!name.starts_with("mpcg") && !name.starts_with("ppcg") && name != "upcg:coupled") continue;
    const Eigen::VectorXd x = iterates_of(c, name, 0.1).x.back();
    EXPECT_LT((c.constraint_rows() * (x - as_eigen(c.z))).norm(), 1e-12 * x.norm()) << name;
  }
}

// What a preconditioner has been given.
struct Seen {
  Index blocks = 0, rows = 0;
  int modes = -1;
  bool modes_first = false;
};

TEST(Registry, PreconditionerGetsTheMatrixThatTheHeaderNames) {
  class Spy : public BlockDiagonalPreconditioner {
   public:
    explicit Spy(Seen& seen) : seen_(seen) {}
    Status update(const BlockCsr& a) override {
      seen_.blocks = a.pattern->blocks(), seen_.rows = a.dofs();
      seen_.modes_first = seen_.modes >= 0;
      return BlockDiagonalPreconditioner::update(a);
    }
    void set_near_null_space(NearNullSpace space) override { seen_.modes = space.modes; }

   private:
    Seen& seen_;
  };
  static Seen seen;
  const auto factory = [](const SolverOptions&) { return std::make_unique<Spy>(seen); };
  register_preconditioner("spy", factory);
  register_preconditioner("spy_core", factory, {.of_core = true, .needs_near_null_space = true});
  const ConstrainedCase c = stiff_case(3);
  const auto core_blocks = static_cast<Index>(std::ranges::count(c.core, std::uint8_t{1}));
  for (const std::string method : {"mpcg:", "upcg:", "ppcg:"}) {
    SCOPED_TRACE(method);
    const Index rows = method == "upcg:" ? c.constraints.free_dofs() : c.size();
    seen = {};
    iterates_of(c, method + "spy");
    EXPECT_EQ(seen.rows, rows);
    EXPECT_EQ(seen.modes, -1);
    const Index all = seen.blocks;
    seen = {};
    iterates_of(c, method + "spy_core");
    EXPECT_EQ(seen.rows, rows);
    EXPECT_LT(seen.blocks, all);
    if (method != "upcg:") {
      EXPECT_EQ(all, c.a.pattern->blocks());
      EXPECT_EQ(seen.blocks, core_blocks);
    }
    EXPECT_EQ(seen.modes, 3);
    EXPECT_TRUE(seen.modes_first);
    EXPECT_TRUE(solver_traits(method + "spy_core").needs_core);
  }
}

TEST(Registry, RefusesNamesThatCannotBe) {
  const SolverFactory solver = [](const SolverOptions&) { return make_solver({.name = "mpcg"}); };
  const PreconditionerFactory preconditioner = [](const SolverOptions&) {
    return std::make_unique<DiagonalPreconditioner>();
  };
  const auto of_solver = [&](const std::string& name) {
    return refusal([&] { register_solver(name, solver); });
  };
  const auto of_preconditioner = [&](const std::string& name) {
    return refusal([&] { register_preconditioner(name, preconditioner); });
  };
  EXPECT_TRUE(says(of_solver(""), "empty name") && says(of_solver(""), "my_solver"));
  EXPECT_TRUE(says(of_preconditioner(""), "my_preconditioner"));
  for (const std::string name : {"two words", "two,words", "two\twords", " two_words"}) {
    EXPECT_TRUE(says(of_solver(name), "two_words\"")) << of_solver(name);
    EXPECT_TRUE(says(of_preconditioner(name), "two_words\"")) << of_preconditioner(name);
  }
  // Taken: by Taut, by Taut in a complete build, by an earlier call, by a variant.
  for (const std::string name : {"auto", "cholmod", "own", "upcg:own"})
    EXPECT_TRUE(says(of_solver(name), "\"" + name + "\" is taken")) << name;
  // There is no ppcg:diagonal, and still.
  for (const std::string name : {"ic0", "diagonal", "own"})
    EXPECT_TRUE(says(of_preconditioner(name), "\"" + name + "\" is taken")) << name;
  EXPECT_FALSE(is_solver_name("ppcg:diagonal"));
}

TEST(Registry, IsKnownWhereNamesAreSuggested) {
  const std::string message = refusal([] { make_solver({.name = "upcg:ovn"}); });
  EXPECT_TRUE(says(message, "did you mean 'upcg:own'?")) << message;
  EXPECT_TRUE(says(message, ", own")) << message;
}

TEST(Registry, WaitsForItsBackend) {
  register_solver("late", [](const SolverOptions&) { return make_solver({.name = "eigen_ldlt"}); },
                  {.needs_backend = "late_backend"});
  EXPECT_TRUE(is_solver_name("late"));
  EXPECT_EQ(std::ranges::count(solver_names(), "late"), 0);
  const std::string message = refusal([] { make_solver({.name = "late"}); });
  EXPECT_TRUE(says(message, "register_cholesky(\"late_backend\"")) << message;
  register_cholesky("late_backend", [] { return std::make_unique<EigenCholesky>(); });
  EXPECT_EQ(std::ranges::count(solver_names(), "late"), 1);
  EXPECT_NE(make_solver({.name = "late"}), nullptr);
}

TEST(Registry, ThreadsRegisterAndMakeAtOnce) {
  constexpr int threads = 4, rounds = 25;
  const ConstrainedCase c = stiff_case(4);
  const auto name = [](int t, int k) { return "thread_" + std::to_string(100 * t + k); };
  std::vector<double> expected(c.b.size());
  make_solver(solver_options("upcg:own", 1e-6))->solve(c.system(), expected);
  std::vector<std::string> failures(threads);
  std::vector<std::thread> running;
  for (int t = 0; t < threads; ++t)
    running.emplace_back([&, t] {
      std::vector<double> x(c.b.size());
      for (int k = 0; k < rounds; ++k) {
        register_solver(name(t, k), [](const SolverOptions& o) {
          return make_solver(solver_options("upcg:own", o.tolerance));
        });
        register_preconditioner(name(t, k), [](const SolverOptions&) {
          return std::make_unique<DiagonalPreconditioner>();
        });
        register_cholesky(name(t, k), [] { return std::make_unique<EigenCholesky>(); });
        for (const std::string& made : {name(t, k), "upcg:" + name(t, k), std::string("core_pcg"),
                                        std::string("auto"), solver_names().back()})
          if (!make_solver({.name = made})) failures[t] = made;
        make_solver(solver_options(name(t, k), 1e-6))->solve(c.system(), x);
        if (x != expected) failures[t] = "other bits of " + name(t, k);
      }
    });
  for (std::thread& thread : running) thread.join();
  for (const std::string& failure : failures) EXPECT_EQ(failure, "");
  for (int t = 0; t < threads; ++t)
    for (int k = 0; k < rounds; ++k) EXPECT_TRUE(is_solver_name("mpcg:" + name(t, k)));
}

}  // namespace
}  // namespace taut::test
