#include "taut/plot/gnuplot_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

#include "taut/base/error.h"
#include "taut/base/file.h"

extern "C" char** environ;

namespace taut {

namespace fs = std::filesystem;

namespace {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code failure;
    fs::path parent = fs::temp_directory_path(failure);
    if (failure) parent = "/tmp";
    std::string name = (parent / "taut-plot-XXXXXX").string();
    if (!::mkdtemp(name.data()))
      throw InputError(
          {parent.string()},
          std::string("no folder can be made there for a plot's data: ") + std::strerror(errno));
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code failure;
    fs::remove_all(path_, failure);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

constexpr const char* how_to_get =
    "plots are drawn by gnuplot, which is not installed; on Debian or Ubuntu: apt-get install "
    "gnuplot-nox";

// Exit code of gnuplot in that folder, its messages in the folder's file "said"; -1 when it was
// ended by a signal.
int spawn_gnuplot(const fs::path& folder) {
  const std::string said = (folder / "said").string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, said.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  // --default-settings: the user's own gnuplot settings would make other figures of the same data.
  const char* arguments[] = {"gnuplot", "--default-settings", "script.gp", nullptr};
  pid_t child = -1;
  const int failure =
      ::posix_spawnp(&child, "gnuplot", &actions, nullptr, const_cast<char**>(arguments), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT) throw InputError(how_to_get);
  if (failure != 0)
    throw InputError(std::string("gnuplot cannot be started: ") + std::strerror(failure));
  int state = 0;
  while (::waitpid(child, &state, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(state) ? WEXITSTATUS(state) : -1;
}

std::string end_of(const std::string& text) {
  return text.size() <= 600 ? text : "..." + text.substr(text.size() - 600);
}

}  // namespace

std::string run_gnuplot(const GnuplotJob& job) {
  const TemporaryFolder folder;
  for (const PlotFile& file : job.files) write_file(folder.path() / file.name, file.content);
  write_file(folder.path() / "script.gp", job.script);
  const int code = spawn_gnuplot(folder.path());
  if (code == 127) throw InputError(how_to_get);  // some C libraries find out only in the child
  std::string drawn;
  if (fs::exists(folder.path() / job.output)) drawn = read_file(folder.path() / job.output);
  if (code != 0 || drawn.empty())
    throw InputError("gnuplot failed (exit code " + std::to_string(code) +
                     ") and said: " + end_of(read_file(folder.path() / "said")));
  return drawn;
}

}  // namespace taut
