// taut bench contact: what contact costs a step, by phase, while nothing touches (ball) and in a
// heap of folds (clump); or, with --stress, every contact scene and jittered copies of it, each of
// which must finish without an intersection in any step, by Taut's own check; and with --judge in
// any frame, by another program.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "bench/benches.h"
#include "bench/table.h"
#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/base/timer.h"
#include "taut/io/child_process.h"
#include "taut/io/obj.h"
#include "taut/scene/scene_file.h"
#include "taut/sim/cloth_model.h"
#include "taut/sim/surface_contact.h"
#include "taut/step/state.h"

namespace taut::app {

namespace {

using Json = nlohmann::ordered_json;

// Where a step's time goes, and what it found; summed up, then divided.
struct Means {
  int steps = 0;
  double near = 0, impulse = 0, detect = 0, zone = 0, contact = 0, check = 0, step = 0, tested = 0,
         pairs = 0, impacts = 0, zone_nodes = 0;

  void add(const StepReport& r) {
    ++steps;
    near += r.near_ms, impulse += r.impulse_ms, detect += r.detect_ms, zone += r.zone_ms,
        contact += r.contact_ms, check += r.check_ms;
    step += r.step_ms, tested += static_cast<double>(r.pairs_tested), pairs += r.near_pairs,
        impacts += r.impacts, zone_nodes += r.zone_nodes;
  }
  double mean(double sum) const { return steps > 0 ? sum / steps : 0.0; }
  std::vector<std::string> row(const std::string& scene, Index nodes) const {
    std::vector<std::string> cells{scene, fmt::format("{}", nodes)};
    for (const double ms : {near, impulse, detect, zone, contact, check, step})
      cells.push_back(fmt::format("{:.1f}", mean(ms)));
    for (const double count : {tested, pairs, impacts, zone_nodes})
      cells.push_back(fmt::format("{:.0f}", mean(count)));
    return cells;
  }
};

Json step_json(const std::string& scene, const StepReport& r, int threads) {
  return {{"scene", scene},
          {"nodes", r.nodes},
          {"solver", r.solver},
          {"threads", threads},
          {"time", r.time},
          {"near_ms", r.near_ms},
          {"impulse_ms", r.impulse_ms},
          {"detect_ms", r.detect_ms},
          {"zone_ms", r.zone_ms},
          {"contact_ms", r.contact_ms},
          {"check_ms", r.check_ms},
          {"step_ms", r.step_ms},
          {"pairs_tested", r.pairs_tested},
          {"near_pairs", r.near_pairs},
          {"impacts", r.impacts},
          {"zones", r.zones},
          {"zone_nodes", r.zone_nodes},
          {"largest_zone", r.largest_zone},
          {"intersections", r.intersections}};
}

void advance(SceneSimulation& simulation, StepReport& record) {
  if (const Status status = simulation.step(record); !status.ok()) throw InputError(status.message);
}

struct ContactRun {
  const char* scene;
  int k_nodes;           // nodes along each side
  double step;           // s; 0: the scene's
  double skip, measure;  // s
};

void measure(const ContactRun& e, const BenchOptions& options, TextTable& table, Json& rows) {
  const int side = options.nodes.empty() ? e.k_nodes : side_of(options.nodes.front());
  std::vector<std::string> settings{fmt::format("cloth.grid.nodes=[{0},{0}]", side),
                                    "solver.name=auto"};
  if (e.step > 0.0) settings.push_back(fmt::format("time.step={}", e.step));
  SceneSimulation simulation(
      read_scene(fmt::format("{}/{}.toml", options.scenes, e.scene), settings));
  StepReport record;
  Means means;
  while (simulation.state().time < e.skip + e.measure) {
    advance(simulation, record);
    rows.push_back(step_json(e.scene, record, thread_count()));
    if (record.time > e.skip) means.add(record);
  }
  table.add(means.row(e.scene, simulation.cloth().nodes()));
}

// ---- stress

constexpr const char* contact_scenes[] = {"clump", "stack",           "twist",
                                          "pinch", "tshirt_cylinder", "body"};

struct Trial {
  std::string end = "finished";
  int steps = 0, retries = 0, most_pairs = 0, impacts = 0;
  Offset intersections = 0, zone_steps = 0, node_steps = 0;
  double seconds = 0.0, kinetic_J = 0.0;
  // frames that another program saw, and in which it found intersections
  int judged = 0, judged_intersecting = 0;
};

// Gives a frame's whole surface to `judge --solid-from K FILE.obj` (tests/contact/judge), which
// exits with 0 or, of intersections, 1.
class FrameJudge {
 public:
  explicit FrameJudge(std::string program) : program_(std::move(program)) {}

  void judge(const SceneSimulation& simulation, Trial& trial) const {
    const SurfaceContact* contact = simulation.surface_contact();
    if (program_.empty() || contact == nullptr) return;
    const CollisionSurface& surface = contact->contact().surface();
    const auto file =
        std::filesystem::temp_directory_path() / fmt::format("taut-judged-{}.obj", getpid());
    write_obj(
        file,
        {contact->positions(simulation.state().time, simulation.state().x), surface.triangles, {}});
    const ChildEnd end = run_child(
        {program_, "--solid-from", std::to_string(simulation.cloth().nodes()), file.string()},
        std::chrono::minutes(5));
    std::filesystem::remove(file);
    if (end.outcome == ChildEnd::Outcome::not_found)
      throw InputError(fmt::format("there is no program '{}'; give --judge another", program_));
    if (end.outcome != ChildEnd::Outcome::exited || end.code > 1)
      throw InputError(
          fmt::format("the judge {} could not judge a frame: {}", program_, end.errors));
    ++trial.judged;
    trial.judged_intersecting += end.code;
  }

 private:
  std::string program_;
};

// The scene; of all scenes, not one whose files are not there (the meshes of `body`).
std::optional<Scene> readable_scene(const std::string& scene, const BenchOptions& options) {
  try {
    return read_scene(fmt::format("{}/{}.toml", options.scenes, scene));
  } catch (const InputError& error) {
    if (!options.methods.empty()) throw;
    fmt::print("{:<16} not run: {}\n", scene, error.what());
    return {};
  }
}

Trial run_trial(Scene read, const BenchOptions& options, int seed) {
  for (Cloth& cloth : read.cloths) {
    if (seed == 0) continue;
    cloth.jitter = std::max(cloth.jitter, 1e-4);
    cloth.jitter_seed = 100u + static_cast<unsigned>(seed);  // not that of the scene itself
  }
  // beyond the scene's own end: it must lie still, too
  const int steps = options.stress_frames * read.time.steps_per_frame;
  Timer timer;
  Trial trial;
  const int steps_per_frame = read.time.steps_per_frame;
  const FrameJudge frame_judge(options.judge);
  SceneSimulation simulation(std::move(read));
  frame_judge.judge(simulation, trial);
  while (trial.steps < steps) {
    StepReport record;
    const Status status = simulation.step(record);
    if (!status.ok()) {
      trial.end = "stopped: " + status.message;
      break;
    }
    ++trial.steps;
    trial.retries += record.retries;
    trial.impacts += record.impacts;
    trial.most_pairs = std::max(trial.most_pairs, record.pushing_pairs);
    trial.intersections += std::max(0, record.intersections);
    trial.zone_steps += record.zone_nodes;
    trial.node_steps += record.nodes;
    trial.kinetic_J = record.kinetic_J;
    if (trial.steps % steps_per_frame == 0) frame_judge.judge(simulation, trial);
  }
  trial.seconds = timer.milliseconds() / 1000.0;
  return trial;
}

// Those asked for, or all that are in the folder: at least one.
std::vector<std::string> scenes_to_stress(const BenchOptions& options) {
  for (const std::string& name : options.methods)
    if (!std::ranges::count(contact_scenes, name))
      throw InputError(fmt::format("--scene: '{}' is none of the contact scenes: {}", name,
                                   fmt::join(contact_scenes, ", ")));
  std::vector<std::string> scenes;
  for (const char* scene : contact_scenes) {
    const bool asked = std::ranges::count(options.methods, scene) > 0;
    if (!options.methods.empty() && !asked) continue;
    const bool there = std::filesystem::exists(fmt::format("{}/{}.toml", options.scenes, scene));
    if (asked && !there)
      throw InputError(
          fmt::format("--scene: there is no {}.toml in {}; give its folder with --scenes", scene,
                      options.scenes));
    if (there) scenes.push_back(scene);
  }
  if (scenes.empty())
    throw InputError(fmt::format("--scenes: {} has none of the contact scenes: {}", options.scenes,
                                 fmt::join(contact_scenes, ", ")));
  return scenes;
}

Json stress(const BenchOptions& options) {
  Json rows = Json::array();
  for (const std::string& scene : scenes_to_stress(options)) {
    const std::optional<Scene> read = readable_scene(scene, options);
    if (!read) continue;
    for (int seed = 0; seed <= options.stress; ++seed) {
      const Trial trial = run_trial(*read, options, seed);
      const double share =
          trial.node_steps > 0 ? double(trial.zone_steps) / double(trial.node_steps) : 0.0;
      fmt::print(
          "{:<16} seed {:>2}: {} steps in {:.0f} s, {} intersections, {}{:.2f} % of node-steps in "
          "zones, at most {} pairs pushing, "
          "{} impacts, {} retries, kinetic energy {:.2g} J, {}\n",
          scene, seed, trial.steps, trial.seconds, trial.intersections,
          options.judge.empty() ? ""
                                : fmt::format("judged: {} of {} frames intersecting, ",
                                              trial.judged_intersecting, trial.judged),
          100.0 * share, trial.most_pairs, trial.impacts, trial.retries, trial.kinetic_J,
          trial.end);
      std::fflush(stdout);
      rows.push_back({{"scene", scene},
                      {"solver", "contact"},
                      {"seed", seed},
                      {"steps", trial.steps},
                      {"seconds", trial.seconds},
                      {"intersections", trial.intersections},
                      {"zone_share", share},
                      {"most_pairs", trial.most_pairs},
                      {"impacts", trial.impacts},
                      {"retries", trial.retries},
                      {"kinetic_J", trial.kinetic_J},
                      {"judged_frames", trial.judged},
                      {"judged_intersecting", trial.judged_intersecting},
                      {"failed", trial.intersections > 0 || trial.judged_intersecting > 0},
                      {"end", trial.end}});
    }
  }
  return rows;
}

}  // namespace

Json bench_contact(const BenchOptions& options) {
  if (options.stress >= 0) return stress(options);
  const ContactRun experiments[] = {
      {"ball", 161, 3.67e-3, 0.0, 0.2},
      {"clump", options.full ? 161 : 81, 0.0, 0.4, options.full ? 0.6 : 0.3}};
  Json rows = Json::array();
  TextTable table({"scene", "nodes", "near ms", "impulses ms", "detection ms", "zones ms",
                   "contact ms", "check ms", "step ms", "pairs tested", "near pairs", "impacts",
                   "zone nodes"});
  for (const ContactRun& e : experiments) measure(e, options, table, rows);
  fmt::print(
      "{}\nMeans a step; of clump in its heap. Paper (Figure 4, 25,921 nodes): 1,080 ms of contact "
      "a step on its machine.\n",
      table.text());
  return rows;
}

}  // namespace taut::app
