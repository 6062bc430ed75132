#include "taut/results/run.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "taut/base/file.h"
#include "taut/base/parallel.h"
#include "taut/base/simd.h"
#include "taut/base/timer.h"
#include "taut/sim/cloth_model.h"
#include "taut/sim/node_contact.h"
#include "taut/sim/surface_contact.h"
#include "taut/step/state.h"
#include "taut/step/stepper.h"

namespace taut {

const char* name_of(RunEnd end) {
  switch (end) {
    case RunEnd::finished:
      return "finished";
    case RunEnd::interrupted:
      return "interrupted";
    case RunEnd::failed:
      return "failed";
  }
  return "unknown";
}

namespace {

double peak_memory_MB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// Sums over the steps of this run, turned into means at the end.
void add_step(RunSummary& summary, const StepReport& r) {
  ++summary.steps;
  summary.mean_step_ms += r.step_ms;
  summary.mean_iterations += r.iterations;
  summary.mean_assemble_ms += r.assemble_ms;
  summary.mean_solver_ms += r.order_ms + r.factor_ms + r.solve_ms;
  summary.mean_contact_ms += r.contact_ms;
  summary.max_iterations = std::max(summary.max_iterations, r.iterations);
  summary.deepest_m = std::max(summary.deepest_m, r.deepest_m);
  summary.fallbacks += r.fallbacks;
}

void note_stretch(RunSummary& summary, const StepReport& r, const SceneSimulation& simulation) {
  if (r.overshoot > 0.0) {
    AcceptedOvershoots& o = summary.overshoots;
    ++o.steps;
    o.largest = std::max(o.largest, r.overshoot);
    if (std::max(r.overshoot, r.max_stretch) > AcceptedOvershoots::torn && o.torn_steps++ == 0)
      o.first_torn = r.step;
  }
  // NaN too: it is not below.
  if (r.max_stretch <= summary.max_stretch) return;
  summary.max_stretch = r.max_stretch;
  summary.worst_stretch = simulation.worst_stretch();
  summary.worst_step = r.step;
  summary.worst_time = r.time;
}

std::string worst_place(const RunSummary& s) {
  return fmt::format("{:.4g} % between nodes {} and {} of cloth '{}' in step {} (t = {:.4g} s)",
                     100.0 * s.worst_stretch.stretch, s.worst_stretch.i, s.worst_stretch.j,
                     s.worst_stretch.cloth, s.worst_step, s.worst_time);
}

void warn(RunSummary& s, const TimeOptions& time) {
  constexpr double twice_its_length = 1.0;
  if (s.overshoots.torn_steps > 0)
    s.warnings.push_back(
        fmt::format("the result is not to be trusted from step {} on: in {} of {} steps springs "
                    "ended up to {:.3g} % of their length beyond what the "
                    "step foresaw, although steps were halved {} times. Worst stretch: {}. Make "
                    "pins and solids that pull there slower, or time.step "
                    "smaller, or allow more halvings (time.max_halvings)",
                    s.overshoots.first_torn, s.overshoots.torn_steps, s.steps,
                    100.0 * s.overshoots.largest, time.max_halvings, worst_place(s)));
  // Integrators that foresee nothing, and steps that may not be halved, end here.
  else if (s.max_stretch > twice_its_length)
    s.warnings.push_back(
        fmt::format("springs were stretched to more than twice their length, as no fabric is: {}. "
                    "Unless that is meant, make pins and "
                    "solids that pull there slower, raise k_stretch, or make time.step smaller",
                    worst_place(s)));
}

// What to do about a step that failed.
std::string advice(const Status& status, const SceneSimulation& simulation) {
  const SurfaceContact* contact = simulation.surface_contact();
  if (contact && !contact->contact().trouble().empty())
    return "leave the cloth there more room, let the pins and solids that hold it move slower or "
           "alike (their key frames), or make "
           "time.step or "
           "contact.thickness smaller; last_good/ shows the place";
  if (status.outcome == Outcome::not_finite)
    return "numbers have grown without bound: make time.step smaller, and look for key frames that "
           "jump and for stiffnesses or masses far "
           "from those of "
           "cloth (`taut check`)";
  if (status.outcome == Outcome::max_iterations && simulation.stepper().integrator().is_nonlinear())
    return "make time.step smaller, allow more with time.newton_max_iterations, or ask for less "
           "with time.newton_tolerance";
  return "make time.step smaller, or take another solver.name";
}

void finish_means(RunSummary& summary) {
  if (summary.steps == 0) return;
  for (double* mean : {&summary.mean_step_ms, &summary.mean_iterations, &summary.mean_assemble_ms,
                       &summary.mean_solver_ms, &summary.mean_contact_ms})
    *mean /= summary.steps;
}

const UntangleReport* untangling(const SceneSimulation& simulation) {
  return simulation.surface_contact() ? simulation.surface_contact()->untangled() : nullptr;
}

void write_summary(const RunSummary& s, const SceneSimulation& simulation,
                   const ResultsFolder& results) {
  const Scene& scene = simulation.scene();
  nlohmann::ordered_json json{{"title", scene.title},
                              {"status", name_of(s.end)},
                              {"message", s.message},
                              {"warnings", s.warnings},
                              {"nodes", s.nodes},
                              {"frames", s.frames},
                              {"steps_total", simulation.steps_done()},
                              {"simulated_s", s.simulated_s},
                              {"h", scene.time.step},
                              {"integrator", name_of(scene.time.integrator)},
                              {"solver", scene.solver.name},
                              {"tolerance", scene.solver.tolerance},
                              {"this_run",
                               {{"steps", s.steps},
                                {"wall_s", s.wall_s},
                                {"mean_step_ms", s.mean_step_ms},
                                {"mean_assemble_ms", s.mean_assemble_ms},
                                {"mean_solver_ms", s.mean_solver_ms},
                                {"mean_contact_ms", s.mean_contact_ms},
                                {"mean_iterations", s.mean_iterations},
                                {"max_iterations", s.max_iterations},
                                {"max_stretch", s.max_stretch},
                                {"max_stretch_step", s.worst_step},
                                {"steps_overshot", s.overshoots.steps},
                                {"largest_overshoot", s.overshoots.largest},
                                {"deepest_m", s.deepest_m},
                                {"fallbacks", s.fallbacks}}},
                              {"threads", thread_count()},
                              {"instruction_set", instruction_set()},
                              {"peak_memory_MB", s.peak_memory_MB},
                              {"taut_version", TAUT_VERSION}};
  if (const UntangleReport* untangled = untangling(simulation))
    json["untangled"] = {{"intersections", untangled->intersections_before},
                         {"inside_solids", untangled->inside_solids_before},
                         {"passes", untangled->passes},
                         {"nodes_moved", untangled->moved},
                         {"largest_m", untangled->largest},
                         {"mean_m", untangled->mean},
                         {"stretch_before", untangled->stretch_before},
                         {"stretch_after", untangled->stretch_after},
                         {"gap_m", untangled->gap}};
  write_file(results.summary_file(), json.dump(2) + "\n");
}

}  // namespace

RunSummary run(SceneSimulation& simulation, const ResultsFolder& results, RunObserver& observer,
               const std::atomic<bool>& interrupt, int first_frame) {
  Timer timer;
  const TimeOptions& time = simulation.scene().time;
  const int steps_total = time.frames * time.steps_per_frame;
  RunSummary summary;
  summary.nodes = simulation.cloth().nodes();
  results.refuse_running();
  results.remove_unfinished();
  // What an earlier part of the run said about its end is over.
  std::filesystem::remove(results.summary_file());
  results.remove_frames_after(first_frame);
  if (first_frame == 0) results.write_frame(0, simulation.state().x, node_contact(simulation));
  if (const UntangleReport* untangled = untangling(simulation); untangled && first_frame == 0)
    observer.on_message(describe(*untangled));
  StatsWriter stats(results.stats_file(), simulation.steps_done());
  int frame = first_frame;
  while (simulation.steps_done() < steps_total) {
    if (interrupt) {
      summary.end = RunEnd::interrupted;
      break;
    }
    StepReport record;
    const Status status = simulation.step(record);
    if (!status.ok()) {
      summary.end = RunEnd::failed;
      summary.message = status.message + "; " + advice(status, simulation);
      save_last_good(simulation, results);
      break;
    }
    if (record.fallbacks > 0)
      observer.on_message(
          fmt::format("step {}: {} had to begin again, in double precision or with another method; "
                      "{} solved it",
                      record.step, simulation.scene().solver.name, record.solver));
    const bool ends_frame = simulation.steps_done() % time.steps_per_frame == 0;
    stats.write(record, simulation.steps_done() / time.steps_per_frame);
    add_step(summary, record);
    note_stretch(summary, record, simulation);
    observer.on_step(record, steps_total);
    if (!ends_frame) continue;
    results.write_frame(++frame, simulation.state().x, node_contact(simulation));
    results.write_checkpoint(simulation, frame);
    observer.on_frame(frame, time.frames);
  }
  summary.frames = frame + 1;
  summary.simulated_s = simulation.state().time;
  summary.wall_s = timer.milliseconds() / 1000.0;
  summary.peak_memory_MB = peak_memory_MB();
  finish_means(summary);
  warn(summary, time);
  write_summary(summary, simulation, results);
  return summary;
}

}  // namespace taut
