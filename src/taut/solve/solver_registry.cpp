#include "taut/solve/solver_registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <utility>

#include "taut/base/error.h"
#include "taut/linalg/sparse_cholesky.h"
#include "taut/solve/solver_table.h"

namespace taut {

namespace {

bool available(const SolverEntry& entry) {
  return entry.make &&
         (entry.traits.needs_backend.empty() || has_cholesky(entry.traits.needs_backend));
}

std::string method_of(const std::string& name) { return name.substr(0, name.find(':')); }

// Entries are copied out, so that nothing runs while the lock is held that may ask again.
class Registry {
 public:
  std::optional<SolverEntry> find(const std::string& name) const {
    const std::shared_lock lock(mutex_);
    const SolverEntry* entry = where(name);
    return entry ? std::optional(*entry) : std::nullopt;
  }

  std::vector<std::string> available_names() const {
    const std::shared_lock lock(mutex_);
    std::vector<std::string> names;
    for (const SolverEntry& entry : entries_)
      if (available(entry)) names.push_back(entry.name);
    return names;
  }

  // All or, where one of the names is taken, none; returns that name.
  std::string add(std::vector<SolverEntry> added) {
    const std::unique_lock lock(mutex_);
    for (const SolverEntry& entry : added)
      if (const SolverEntry* known = where(entry.name); known && known->make) return entry.name;
    for (SolverEntry& entry : added) put(std::move(entry));
    return {};
  }

 private:
  const SolverEntry* where(const std::string& name) const {
    const auto at = std::ranges::find(entries_, name, &SolverEntry::name);
    return at == entries_.end() ? nullptr : &*at;
  }

  // Into the place that is kept for it, else behind the last of its method, else at the end.
  void put(SolverEntry entry) {
    const auto kept = std::ranges::find(entries_, entry.name, &SolverEntry::name);
    if (kept != entries_.end()) {
      *kept = std::move(entry);
      return;
    }
    const auto last = std::find_if(entries_.rbegin(), entries_.rend(), [&](const SolverEntry& e) {
      return method_of(e.name) == method_of(entry.name);
    });
    entries_.insert(last == entries_.rend() ? entries_.end() : last.base(), std::move(entry));
  }

  mutable std::shared_mutex mutex_;
  std::vector<SolverEntry> entries_ = builtin_solvers();
};

Registry& registry() {
  static Registry one;
  return one;
}

void check_name(const char* what, const std::string& name) {
  if (name.empty())
    throw InputError(
        fmt::format("a {} cannot be registered under an empty name: give it one, such as "
                    "\"my_{}\"",
                    what, what));
  constexpr const char* separators = " \t\r\n\v\f,";
  if (name.find_first_of(separators) == std::string::npos) return;
  std::string better = name;
  for (char& c : better)
    if (std::string_view(separators).find(c) != std::string_view::npos) c = '_';
  throw InputError(
      fmt::format("the {} name \"{}\" has a blank or a comma in it, which separate names in lists: "
                  "register it as \"{}\"",
                  what, name, better));
}

std::string how_to_get(const std::string& backend) {
  if (backend == "pardiso")
    return "type './taut setup pardiso' (or install oneMKL and build with -DTAUT_WITH_PARDISO=ON)";
  if (backend == "cholmod") return "build with -DTAUT_WITH_CHOLMOD=ON";
  return fmt::format("call register_cholesky(\"{}\", ...) first", backend);
}

}  // namespace

std::unique_ptr<ConstrainedSolver> make_solver(const SolverOptions& options) {
  const std::optional<SolverEntry> entry = registry().find(options.name);
  if (!entry) {
    const std::vector<std::string> known = solver_names();
    const std::string near = nearest_name(options.name, known);
    throw InputError(fmt::format("unknown solver '{}'{}; the solvers are: {}", options.name,
                                 near.empty() ? "" : fmt::format(" (did you mean '{}'?)", near),
                                 fmt::join(known, ", ")));
  }
  if (!available(*entry)) {
    const std::string& backend = entry->traits.needs_backend;
    throw InputError(fmt::format(
        "solver '{}' needs the {} backend, which is not built into this program; {}, or use one "
        "of: {}",
        options.name, backend, how_to_get(backend), fmt::join(solver_names(), ", ")));
  }
  std::unique_ptr<ConstrainedSolver> solver = entry->make(options);
  assert(solver);
  solver->traits_ = entry->traits;
  return solver;
}

void register_solver(const std::string& name, SolverFactory factory, SolverTraits traits) {
  assert(factory);
  check_name("solver", name);
  if (!registry().add({{name, std::move(factory), std::move(traits)}}).empty())
    throw InputError(fmt::format(
        "the solver name \"{}\" is taken: register this one under another name, once", name));
}

void register_preconditioner(const std::string& name, PreconditionerFactory factory,
                             PreconditionerTraits traits) {
  assert(factory);
  check_name("preconditioner", name);
  PreconditionerChoice choice;
  choice.source = traits.of_core ? PreconditionerSource::core : PreconditionerSource::constrained;
  choice.make = [factory = std::move(factory)](const SolverOptions& options, const ConstraintSet*) {
    std::unique_ptr<Preconditioner> made = factory(options);
    assert(made);
    return made;
  };
  choice.wants_near_null_space = traits.needs_near_null_space;
  choice.keeps_free_directions = false;
  const std::string taken = registry().add(preconditioned_solvers({name, std::move(choice)}));
  if (!taken.empty())
    throw InputError(fmt::format(
        "the preconditioner name \"{}\" is taken, there is a solver {} already: register this one "
        "under another name, once",
        name, taken));
}

SolverTraits solver_traits(const std::string& name) {
  const std::optional<SolverEntry> entry = registry().find(name);
  return entry ? entry->traits : SolverTraits{};
}

std::vector<std::string> solver_names() { return registry().available_names(); }

bool is_solver_name(const std::string& name) { return registry().find(name).has_value(); }

bool SolverOptions::chooses_core() const {
  return core.empty() ? solver_traits(name).chooses_core : core == "auto";
}

}  // namespace taut
