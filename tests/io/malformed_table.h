#pragma once
// A table of odd and broken files with what must come out of each, and the check that no file of
// that kind is missing in the table.

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "io/limits.h"
#include "taut/base/error.h"
#include "test_data.h"

namespace taut::test {

// `place`: empty when the file must be read, and `outcome` is then the whole summary; else the
// ":line:column" that must follow the file's name in the message, and `outcome` a piece of the
// message.
constexpr const char* refused_without_line = "-";  // the file as a whole is at fault
struct ExpectedOutcome {
  const char* file;
  const char* place;
  const char* outcome;
};

inline void check_outcome(
    const ExpectedOutcome& expected, const std::filesystem::path& path,
    const std::function<std::string(const std::filesystem::path&)>& summary_of) {
  const std::string found = run_limited([&]() -> std::string {
    try {
      return "read " + summary_of(path);
    } catch (const InputError& refusal) {
      return std::string("refused ") + refusal.what();
    }
  });
  const std::string place = expected.place;
  if (place.empty()) {
    EXPECT_EQ(found, std::string("read ") + expected.outcome) << expected.file;
    return;
  }
  const std::string located_file = path.string() + (place == refused_without_line ? "" : place);
  EXPECT_EQ(found.rfind("refused " + located_file + ": ", 0), 0u)
      << "expected place " << place << ", found: " << found;
  EXPECT_NE(found.find(expected.outcome), std::string::npos)
      << "expected '" << expected.outcome << "', found: " << found;
}

inline void check_table(
    const std::vector<ExpectedOutcome>& table, const std::string& extension,
    const std::function<std::string(const std::filesystem::path&)>& summary_of) {
  const auto data = data_folder();
  if (!data)
    GTEST_SKIP() << "no ../shared/data and no $TAUT_DATA: the odd and broken files are not tested";
  std::set<std::string> listed;
  for (const ExpectedOutcome& expected : table) {
    listed.insert(expected.file);
    check_outcome(expected, *data / "malformed" / expected.file, summary_of);
  }
  for (const auto& entry : std::filesystem::directory_iterator(*data / "malformed")) {
    const std::string name = entry.path().filename().string();
    const bool concerned = entry.path().extension() == extension;
    EXPECT_TRUE(!concerned || listed.count(name))
        << name << " has no expected outcome in the table";
  }
}

}  // namespace taut::test
