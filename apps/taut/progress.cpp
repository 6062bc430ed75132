#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include "taut/base/timer.h"

namespace taut::app {

namespace {

std::string duration(double seconds) {
  if (seconds < 100.0) return fmt::format("{:.0f} s", seconds);
  const int minutes = static_cast<int>(seconds / 60.0 + 0.5);
  return minutes < 100 ? fmt::format("{} min", minutes) : fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

class LineProgress : public RunObserver {
 public:
  LineProgress(const Scene& scene, bool terminal) : steps_per_frame_(scene.time.steps_per_frame), terminal_(terminal) {}
  ~LineProgress() override {
    if (terminal_ && shown_) fmt::print(stderr, "\n");
  }

  void on_step(const StepRecord& r, int steps_total) override {
    if (first_step_ == 0) first_step_ = r.step;
    const double done = r.step - first_step_ + 1, elapsed = timer_.milliseconds() / 1000.0;
    const double left = elapsed / done * (steps_total - r.step);
    // Ten times a second is smooth for the eye; a log file wants a line in five seconds at most.
    const double pause = terminal_ ? 0.1 : 5.0;
    if (shown_ && elapsed - last_shown_ < pause && r.step != steps_total) return;
    last_shown_ = elapsed;
    shown_ = true;
    const std::string line =
        fmt::format("frame {}/{}  t = {:.3f} s  {:.1f} steps/s  {} left  {} iterations  max stretch {:.1f} %  {} contacts", r.step / steps_per_frame_,
                    steps_total / steps_per_frame_, r.time, done / elapsed, duration(left), r.iterations, 100.0 * r.max_stretch, r.contacts);
    if (terminal_) {
      fmt::print(stderr, "\r{} {}\033[K", bar(r.step, steps_total), line);
      std::fflush(stderr);
    } else {
      fmt::print(stderr, "{}\n", line);
    }
  }

  void on_message(const std::string& text) override { fmt::print(stderr, "{}{}\n", terminal_ && shown_ ? "\n" : "", text); }

 private:
  static std::string bar(int done, int total) {
    constexpr int width = 20;
    const int filled = total > 0 ? done * width / total : width;
    return "[" + std::string(static_cast<std::size_t>(filled), '#') + std::string(static_cast<std::size_t>(width - filled), '.') + "]";
  }
  Timer timer_;
  int steps_per_frame_, first_step_ = 0;
  bool terminal_, shown_ = false;
  double last_shown_ = 0.0;
};

class JsonProgress : public RunObserver {
 public:
  void on_step(const StepRecord& r, int steps_total) override {
    fmt::print("{{\"step\":{},\"steps\":{},\"time\":{:.9g},\"solver\":\"{}\",\"iterations\":{},\"contacts\":{},\"max_stretch\":{:.6g},\"step_ms\":{:.3f}}}\n", r.step,
               steps_total, r.time, r.solver, r.iterations, r.contacts, r.max_stretch, r.step_ms);
    std::fflush(stdout);
  }
};

}  // namespace

std::unique_ptr<RunObserver> make_progress(ProgressStyle style, const Scene& scene) {
  switch (style) {
    case ProgressStyle::quiet: return std::make_unique<RunObserver>();
    case ProgressStyle::json_lines: return std::make_unique<JsonProgress>();
    case ProgressStyle::automatic: break;
  }
  return std::make_unique<LineProgress>(scene, isatty(STDERR_FILENO) != 0);
}

}  // namespace taut::app
