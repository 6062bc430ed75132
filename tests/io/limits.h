#pragma once
// Runs a task in a child process with at most 1 GB of memory and kills it after two seconds.

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <functional>
#include <string>

namespace taut::test {

// Address sanitizer reserves terabytes of address space, so only the time is limited there.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool memory_can_be_limited = false;
#else
constexpr bool memory_can_be_limited = true;
#endif

inline void write_all(int pipe, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = ::write(pipe, text.data() + done, text.size() - done);
    if (count <= 0) return;
    done += static_cast<std::size_t>(count);
  }
}

inline void limit_this_process() {
  if (memory_can_be_limited) {
    const rlimit memory{std::size_t{1} << 30, std::size_t{1} << 30};
    ::setrlimit(RLIMIT_AS, &memory);
  }
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::alarm(2);
}

// The text that `task` returns, or "died: ..." when it crashed, took too long or let an exception
// out.
inline std::string run_limited(const std::function<std::string()>& task) {
  int ends[2];
  if (::pipe(ends) != 0) return "died: no pipe";
  const pid_t child = ::fork();
  if (child < 0) return "died: no process";
  if (child == 0) {
    limit_this_process();
    try {
      write_all(ends[1], task());
    } catch (const std::exception& error) {
      write_all(ends[1], std::string("died: exception ") + error.what());
    }
    ::_exit(0);
  }
  ::close(ends[1]);
  std::string text;
  char piece[4096];
  for (ssize_t count; (count = ::read(ends[0], piece, sizeof piece)) > 0;)
    text.append(piece, static_cast<std::size_t>(count));
  ::close(ends[0]);
  int state = 0;
  ::waitpid(child, &state, 0);
  if (WIFSIGNALED(state))
    return std::string("died: signal ") +
           (WTERMSIG(state) == SIGALRM ? "ALRM (2 s are over)" : std::to_string(WTERMSIG(state)));
  return WEXITSTATUS(state) == 0 ? text : "died: exit status " + std::to_string(WEXITSTATUS(state));
}

}  // namespace taut::test
