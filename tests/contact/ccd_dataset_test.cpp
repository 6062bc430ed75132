// The handmade queries of Wang et al. 2021, all of them: not one may be missed.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "ccd_queries.h"
#include "taut/contact/ccd.h"
#include "test_data.h"

namespace taut {

std::vector<test::CcdQuery> test::read_ccd_queries(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::vector<CcdQuery> queries;
  std::string line;
  for (int row = 0; std::getline(stream, line); ++row) {
    if (row % 8 == 0) queries.emplace_back();
    std::stringstream fields(line);
    double number[7];
    for (double& n : number) {
      std::string field;
      std::getline(fields, field, ',');
      n = std::stod(field);
    }
    queries.back().corners[row % 8] = {number[0] / number[1], number[2] / number[3],
                                       number[4] / number[5]};
    queries.back().hits = number[6] != 0.0;
  }
  return queries;
}

namespace {

struct Counts {
  int queries = 0, missed = 0, false_alarms = 0;
};

template <class Impact>
void count(const std::filesystem::path& folder, const Impact& impact, Counts& counts) {
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    for (const test::CcdQuery& q : test::read_ccd_queries(entry.path())) {
      const bool hit = impact(q.corners).hit;
      ++counts.queries;
      counts.missed += q.hits && !hit;
      counts.false_alarms += hit && !q.hits;
    }
}

}  // namespace

TEST(CcdDataset, MissesNothing) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "no ../shared/data and no $TAUT_DATA";
  Counts counts;
  const CcdOptions options;
  count(
      *data / "ccd/unit-tests/vertex-face",
      [&](const auto& x) {
        return vertex_triangle_impact(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], options);
      },
      counts);
  count(
      *data / "ccd/unit-tests/edge-edge",
      [&](const auto& x) {
        return edge_edge_impact(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], options);
      },
      counts);
  EXPECT_EQ(counts.queries, 324);
  EXPECT_EQ(counts.missed, 0);
  EXPECT_EQ(counts.false_alarms, 0);
}

}  // namespace taut
