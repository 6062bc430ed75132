#include "progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "taut/base/timer.h"

namespace taut::app {

namespace {

std::string duration(double seconds) {
  if (seconds < 100.0) return fmt::format("{:.0f} s", seconds);
  const int minutes = static_cast<int>(std::min(seconds, 1e8) / 60.0 + 0.5);
  return minutes < 100 ? fmt::format("{} min", minutes)
                       : fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

std::string pace(double steps_per_s) {
  return steps_per_s >= 1.0 ? fmt::format("{:.1f} steps/s", steps_per_s)
                            : fmt::format("{:.1f} s a step", 1.0 / std::max(steps_per_s, 1e-9));
}

// How fast, and how long still, from the steps of this run so far; a resumed run does not count
// those before it.
class Pace {
 public:
  void note(const StepReport& r, int steps_total) {
    if (first_step_ == 0) first_step_ = r.step;
    elapsed_ = timer_.milliseconds() / 1000.0;
    steps_per_s_ = elapsed_ > 0.0 ? (r.step - first_step_ + 1) / elapsed_ : 0.0;
    left_ = steps_per_s_ > 0.0 ? (steps_total - r.step) / steps_per_s_ : 0.0;
  }
  double elapsed() const { return elapsed_; }
  double steps_per_s() const { return steps_per_s_; }
  double left() const { return left_; }

 private:
  Timer timer_;
  int first_step_ = 0;
  double elapsed_ = 0.0, steps_per_s_ = 0.0, left_ = 0.0;
};

int terminal_columns() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string bar(int done, int total) {
  constexpr int width = 20;
  const int filled =
      total > 0 ? static_cast<int>(static_cast<long long>(done) * width / total) : width;
  return "[" + std::string(static_cast<std::size_t>(filled), '#') +
         std::string(static_cast<std::size_t>(width - filled), '.') + "] ";
}

class LineProgress : public RunObserver {
 public:
  LineProgress(const Scene& scene, bool terminal) : time_(scene.time), terminal_(terminal) {
    // The first step of a large scene takes a while.
    if (terminal_)
      show(0, time_.frames * time_.steps_per_frame,
           {fmt::format("frame 0/{}", time_.frames), "begins"});
  }
  ~LineProgress() override {
    if (terminal_ && on_line_) fmt::print(stderr, "\n");
  }

  void on_step(const StepReport& r, int steps_total) override {
    pace_.note(r, steps_total);
    // Ten times a second is smooth for the eye; a log file wants a line in five seconds at most.
    const double pause = terminal_ ? 0.1 : 5.0;
    if (shown_ && pace_.elapsed() - last_shown_ < pause && r.step != steps_total) return;
    last_shown_ = pace_.elapsed();
    shown_ = true;
    show(r.step, steps_total,
         {fmt::format("frame {}/{}", r.step / time_.steps_per_frame,
                      steps_total / time_.steps_per_frame),
          duration(pace_.left()) + " left", fmt::format("t = {:.3f} s", r.time),
          pace(pace_.steps_per_s()), fmt::format("{} iterations", r.iterations),
          fmt::format("stretch {:.1f} %", 100.0 * r.max_stretch),
          fmt::format("{} contacts", r.contacts)});
  }

  void on_message(const std::string& text) override {
    fmt::print(stderr, "{}{}\n", on_line_ ? "\r\033[K" : "", text);
    on_line_ = false;
  }

 private:
  // What does not fit into a terminal's line is left out, the last first: a line that wraps could
  // not be written over.
  void show(int step, int steps_total, const std::vector<std::string>& parts) {
    std::string line = terminal_ ? bar(step, steps_total) : "";
    const std::size_t columns =
        terminal_ ? static_cast<std::size_t>(terminal_columns()) - 1 : std::string::npos;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const std::string part = (k > 0 ? "  " : "") + parts[k];
      if (line.size() + part.size() > columns) break;
      line += part;
    }
    fmt::print(stderr, "{}{}{}", terminal_ ? "\r" : "", line.substr(0, columns),
               terminal_ ? "\033[K" : "\n");
    std::fflush(stderr);
    on_line_ = terminal_;
  }

  TimeOptions time_;
  Pace pace_;
  bool terminal_, shown_ = false, on_line_ = false;
  double last_shown_ = 0.0;
};

// Infinities and NaN, which JSON has not, become null.
class JsonProgress : public RunObserver {
 public:
  explicit JsonProgress(const Scene& scene) : steps_per_frame_(scene.time.steps_per_frame) {}

  void on_step(const StepReport& r, int steps_total) override {
    pace_.note(r, steps_total);
    print({{"step", r.step},
           {"steps", steps_total},
           {"frame", r.step / steps_per_frame_},
           {"frames", steps_total / steps_per_frame_},
           {"time", r.time},
           {"solver", r.solver},
           {"iterations", r.iterations},
           {"contacts", r.contacts},
           {"max_stretch", r.max_stretch},
           {"kinetic_J", r.kinetic_J},
           {"elastic_J", r.elastic_J},
           {"step_ms", r.step_ms},
           {"steps_per_s", pace_.steps_per_s()},
           {"left_s", pace_.left()}});
  }
  void on_message(const std::string& text) override { print({{"message", text}}); }

 private:
  static void print(const nlohmann::ordered_json& line) {
    // Where nobody takes the lines any more (a full disk) the run goes on; main() says so at the
    // end.
    const std::string text =
        line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    std::fputs(text.c_str(), stdout);
    std::fflush(stdout);
  }
  Pace pace_;
  int steps_per_frame_;
};

}  // namespace

std::unique_ptr<RunObserver> make_progress(ProgressStyle style, const Scene& scene) {
  switch (style) {
    case ProgressStyle::quiet:
      return std::make_unique<RunObserver>();
    case ProgressStyle::json_lines:
      return std::make_unique<JsonProgress>(scene);
    case ProgressStyle::automatic:
      break;
  }
  return std::make_unique<LineProgress>(scene, isatty(STDERR_FILENO) != 0);
}

}  // namespace taut::app
