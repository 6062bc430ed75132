#include "taut/io/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "taut/base/error.h"

extern "C" char** environ;

namespace taut {

namespace {

class Pipe {
 public:
  Pipe() {
    // Not inherited by children that other threads start.
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0)
      throw InputError(std::string("no pipe can be had: ") + std::strerror(errno));
  }
  ~Pipe() {
    close(0);
    close(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int reader() const { return ends_[0]; }
  int writer() const { return ends_[1]; }
  void close(int end) {
    if (ends_[end] >= 0) ::close(ends_[end]);
    ends_[end] = -1;
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

class SpawnActions {
 public:
  SpawnActions() { posix_spawn_file_actions_init(&actions_); }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;
  posix_spawn_file_actions_t* get() { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

// Takes what there is; false at the end.
bool take(int descriptor, std::string& text) {
  std::array<char, 65536> piece;
  const ssize_t count = ::read(descriptor, piece.data(), piece.size());
  if (count > 0) text.append(piece.data(), static_cast<std::size_t>(count));
  return count > 0 || (count < 0 && errno == EINTR);
}

// Reads both pipes to their ends; false when the deadline comes first.
bool listen(Pipe& output, Pipe& errors, ChildEnd& end,
            std::chrono::steady_clock::time_point deadline) {
  for (;;) {
    // -1 is passed over
    std::array<pollfd, 2> waiting{pollfd{output.reader(), POLLIN, 0},
                                  pollfd{errors.reader(), POLLIN, 0}};
    if (waiting[0].fd < 0 && waiting[1].fd < 0) return true;
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
                          deadline - std::chrono::steady_clock::now())
                          .count();
    if (left <= 0) return false;
    const int ready = ::poll(waiting.data(), waiting.size(), static_cast<int>(left));
    if (ready < 0 && errno != EINTR) return false;
    if (ready <= 0) continue;
    if (waiting[0].revents != 0 && !take(output.reader(), end.output)) output.close(0);
    if (waiting[1].revents != 0 && !take(errors.reader(), end.errors)) errors.close(0);
  }
}

}  // namespace

ChildEnd run_child(const std::vector<std::string>& arguments, std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  Pipe output, errors;
  SpawnActions actions;
  posix_spawn_file_actions_addopen(actions.get(), 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(actions.get(), output.writer(), 1);
  posix_spawn_file_actions_adddup2(actions.get(), errors.writer(), 2);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t child = -1;
  ChildEnd end;
  const int failure = ::posix_spawnp(&child, argv[0], actions.get(), nullptr, argv.data(), environ);
  if (failure == ENOENT || failure == EACCES) {
    end.outcome = ChildEnd::Outcome::not_found;
    return end;
  }
  if (failure != 0)
    throw InputError(arguments[0] + " cannot be started: " + std::strerror(failure));
  output.close(1);
  errors.close(1);
  const bool in_time = listen(output, errors, end, deadline);
  if (!in_time) ::kill(child, SIGKILL);
  int state = 0;
  pid_t waited;
  do waited = ::waitpid(child, &state, 0);
  while (waited < 0 && errno == EINTR);
  // Who ignores SIGCHLD, or was started so, is not told.
  if (waited < 0)
    throw InputError("how " + arguments[0] + " ended is not known: " + std::strerror(errno));
  if (!in_time)
    end.outcome = ChildEnd::Outcome::too_slow;
  else if (!WIFEXITED(state))
    end.outcome = ChildEnd::Outcome::killed;
  else
    end.code = WEXITSTATUS(state);
  if (end.outcome == ChildEnd::Outcome::exited && end.code == 127)
    end.outcome = ChildEnd::Outcome::not_found;
  return end;
}

}  // namespace taut
