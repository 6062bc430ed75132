#include "taut/base/error.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "taut/base/status.h"

namespace taut::test {
namespace {

TEST(Located, LeavesOutWhatIsNotKnown) {
  EXPECT_EQ(located({"a.toml", 3, 7}, "bad"), "a.toml:3:7: bad");
  EXPECT_EQ(located({"a.toml", 3, 0}, "bad"), "a.toml:3: bad");
  EXPECT_EQ(located({"a.toml", 0, 0}, "bad"), "a.toml: bad");
  EXPECT_EQ(located({"a.toml", 0, 7}, "bad"), "a.toml: bad");
  EXPECT_EQ(located({}, "bad"), "bad");
}

TEST(InputError, CarriesThePlace) {
  const InputError error({"cloth.obj", 12, 1}, "a vertex of 2 numbers");
  EXPECT_STREQ(error.what(), "cloth.obj:12:1: a vertex of 2 numbers");
}

const std::vector<std::string> solvers = {"mpcg", "upcg", "core_pcg", "cholmod", "eigen_ldlt"};

TEST(NearestName, MendsSlipsOfTheFinger) {
  EXPECT_EQ(nearest_name("cholmd", solvers), "cholmod");     // a letter missing
  EXPECT_EQ(nearest_name("chollmod", solvers), "cholmod");   // one too many
  EXPECT_EQ(nearest_name("core_pgc", solvers), "core_pcg");  // two swapped
  EXPECT_EQ(nearest_name("core-pcg", solvers), "core_pcg");  // one wrong
  EXPECT_EQ(nearest_name("eigen_ldlt", solvers), "eigen_ldlt");
}

TEST(NearestName, PrefersTheNearer) {
  EXPECT_EQ(nearest_name("upcgg", solvers), "upcg");
  EXPECT_EQ(nearest_name("mpc", solvers), "mpcg");
}

TEST(NearestName, SaysNothingAboutADifferentWord) {
  EXPECT_EQ(nearest_name("jacobi", solvers), "");
  EXPECT_EQ(nearest_name("ic", solvers), "");
  EXPECT_EQ(nearest_name("upcg", {}), "");
  EXPECT_EQ(nearest_name("", solvers), "");
}

TEST(Status, OnlyConvergedIsOkAndEachOutcomeHasItsName) {
  std::set<std::string> names;
  for (const Outcome outcome :
       {Outcome::converged, Outcome::max_iterations, Outcome::not_positive_definite,
        Outcome::not_finite, Outcome::breakdown, Outcome::out_of_memory}) {
    EXPECT_EQ((Status{outcome, ""}.ok()), outcome == Outcome::converged);
    names.insert(name_of(outcome));
  }
  EXPECT_EQ(names.size(), 6u);
  EXPECT_EQ(names.count("unknown"), 0u);
}

}  // namespace
}  // namespace taut::test
