#pragma once
// Runs the program as its users do, in a child process: what it printed, how it ended. TAUT_PROGRAM
// is the path of the built program.

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace taut::test {

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// A folder of the test's own, which is also where the program runs.
class WorkFolder {
 public:
  WorkFolder() {
    static std::atomic<int> made{0};
    path_ = std::filesystem::temp_directory_path() /
            ("taut_apps_" + std::to_string(::getpid()) + "_" + std::to_string(made++));
    std::filesystem::create_directories(path_);
  }
  ~WorkFolder() {
    std::error_code failure;
    std::filesystem::remove_all(path_, failure);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::filesystem::path file(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

struct ProgramEnd {
  int exit_code = -1;  // -1: ended by a signal
  std::string out, err;
};

// A started program; wait() must be called.
class RunningProgram {
 public:
  RunningProgram(const WorkFolder& folder, const std::vector<std::string>& arguments)
      : out_(folder / ".stdout"), err_(folder / ".stderr") {
    std::vector<char*> argv{const_cast<char*>(TAUT_PROGRAM)};
    for (const std::string& argument : arguments)
      argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    child_ = ::fork();
    if (child_ != 0) return;
    const auto redirect = [](const std::filesystem::path& path, int to) {
      ::dup2(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), to);
    };
    redirect("/dev/null", STDIN_FILENO);
    redirect(out_, STDOUT_FILENO), redirect(err_, STDERR_FILENO);
    if (::chdir(folder.path().c_str()) == 0) ::execv(TAUT_PROGRAM, argv.data());
    ::_exit(127);
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  void send(int signal) const { ::kill(child_, signal); }
  // Until `condition` holds; false when 60 s pass first.
  static bool wait_until(const std::function<bool()>& condition) {
    for (int n = 0; n < 6000; ++n, std::this_thread::sleep_for(std::chrono::milliseconds(10)))
      if (condition()) return true;
    return false;
  }
  ProgramEnd wait() const {
    int state = 0;
    ::waitpid(child_, &state, 0);
    return {WIFEXITED(state) ? WEXITSTATUS(state) : -1, read_text(out_), read_text(err_)};
  }

 private:
  std::filesystem::path out_, err_;
  pid_t child_ = -1;
};

inline ProgramEnd taut(const WorkFolder& folder, const std::vector<std::string>& arguments) {
  return RunningProgram(folder, arguments).wait();
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

inline std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',')
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

// File and folder names in a folder, sorted.
inline std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

// A small sheet that falls on a sphere: contact from about the tenth step on.
inline const char* small_scene() {
  return R"(title = "Small"
[time]
step = 5e-3
frames = 6
steps_per_frame = 3
[[cloth]]
name = "sheet"
grid = { nodes = [9, 8], origin = [-0.3, -0.3, 0.31], u = [0.6, 0, 0], v = [0, 0.6, 0] }
density = 0.15
k_stretch = 500
jitter = 1e-3
[[cloth.pin]]
corners = ["u0v0"]
[[solid]]
shape = "sphere"
radius = 0.3
friction = 0.3
)";
}

}  // namespace taut::test
