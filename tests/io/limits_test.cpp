// The limits that the tables of broken files rely on do bite.
#include "io/limits.h"

#include <gtest/gtest.h>

#include <vector>

namespace taut::test {
namespace {

TEST(RunLimited, HandsBackTheText) {
  const std::string text(100000, 'x');
  EXPECT_EQ(run_limited([&] { return text; }), text);
}

TEST(RunLimited, TooMuchMemoryIsSeen) {
  if (!memory_can_be_limited) GTEST_SKIP() << "the memory of a sanitized program cannot be limited";
  EXPECT_EQ(run_limited([] {
              return std::string(std::size_t{3} << 29, 'x');
            }).rfind("died: exception", 0),
            0u);
}

TEST(RunLimited, CrashAndHangAreSeen) {
  EXPECT_EQ(run_limited([]() -> std::string { ::_exit(3); }), "died: exit status 3");
  EXPECT_EQ(run_limited([]() -> std::string {
              for (;;) ::pause();
            }),
            "died: signal ALRM (2 s are over)");
}

}  // namespace
}  // namespace taut::test
