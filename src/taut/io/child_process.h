#pragma once
// Runs another program and keeps what it prints. No shell: arguments arrive as they are.

#include <chrono>
#include <string>
#include <vector>

namespace taut {

struct ChildEnd {
  enum class Outcome { exited, killed, too_slow, not_found };
  Outcome outcome = Outcome::exited;
  int code = 0;  // of a child that exited
  std::string output, errors;
};

// arguments[0] is looked for in PATH. Its standard input is empty. A child that has not ended after
// `patience` is killed. Throws InputError when the system cannot start anything, or does not say
// how it ended (it says nothing to those who ignore SIGCHLD).
ChildEnd run_child(const std::vector<std::string>& arguments, std::chrono::milliseconds patience);

}  // namespace taut
