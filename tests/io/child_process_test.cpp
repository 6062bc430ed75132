// Programs that are run and heard out.

#include "taut/io/child_process.h"

#include <gtest/gtest.h>

#include <csignal>

#include "taut/base/error.h"

namespace taut {
namespace {

using Outcome = ChildEnd::Outcome;
using namespace std::chrono_literals;

TEST(ChildProcess, ArgumentsArriveAsTheyAre) {
  const ChildEnd end = run_child({"printf", "%s|", "a b", "$HOME; echo no", "'\"", ""}, 10s);
  EXPECT_EQ(end.outcome, Outcome::exited);
  EXPECT_EQ(end.code, 0);
  EXPECT_EQ(end.output, "a b|$HOME; echo no|'\"||");
}

TEST(ChildProcess, BothOutputsAreHeardHoweverMuchItIs) {
  // More than any pipe holds, in both: who reads one to its end first would wait for ever.
  const ChildEnd end = run_child(
      {"sh", "-c", "head -c 3000000 /dev/zero >&2; head -c 2000000 /dev/zero; exit 7"}, 20s);
  EXPECT_EQ(end.outcome, Outcome::exited);
  EXPECT_EQ(end.code, 7);
  EXPECT_EQ(end.output.size(), 2000000u);
  EXPECT_EQ(end.errors.size(), 3000000u);
}

TEST(ChildProcess, ThereIsNothingToRead) {
  const ChildEnd end = run_child({"cat"}, 10s);
  EXPECT_EQ(end.outcome, Outcome::exited);
  EXPECT_EQ(end.output, "");
}

TEST(ChildProcess, PatienceEnds) {
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(run_child({"sleep", "100"}, 300ms).outcome, Outcome::too_slow);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 50s);
}

// As under a supervisor that ignores SIGCHLD, which its children inherit: no end may be taken for a
// good one.
TEST(ChildProcess, AnEndThatIsNotToldIsNoGoodEnd) {
  const auto usual = ::signal(SIGCHLD, SIG_IGN);
  EXPECT_THROW(run_child({"sh", "-c", "exit 3"}, 10s), InputError);
  ::signal(SIGCHLD, usual);
}

TEST(ChildProcess, OtherEndsAreTold) {
  EXPECT_EQ(run_child({"sh", "-c", "kill -9 $$"}, 10s).outcome, Outcome::killed);
  EXPECT_EQ(run_child({"/nowhere/no-such-program"}, 10s).outcome, Outcome::not_found);
  EXPECT_EQ(run_child({"no-such-program-anywhere"}, 10s).outcome, Outcome::not_found);
}

}  // namespace
}  // namespace taut
