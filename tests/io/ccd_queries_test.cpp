#include "taut/io/ccd_queries.h"

#include <gtest/gtest.h>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "test_data.h"

namespace taut {

namespace {

const std::filesystem::path file =
    std::filesystem::temp_directory_path() / "taut_ccd_queries_test.csv";

std::string rows(int count, const std::string& row) {
  std::string text;
  for (int k = 0; k < count; ++k) text += row + "\n";
  return text;
}

std::string complaint(const std::string& text) {
  write_file(file, text);
  try {
    read_ccd_queries(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

void expect_complaint(const std::string& text, const std::string& place, const std::string& words) {
  const std::string message = complaint(text);
  EXPECT_TRUE(message.starts_with(file.string() + place)) << message;
  EXPECT_NE(message.find(words), std::string::npos) << message;
}

}  // namespace

TEST(CcdQueries, ReadsCornersAndTruth) {
  std::string text;
  for (int k = 0; k < 8; ++k)
    text += std::to_string(k) + ",4, -1 ,8,3602879701896397,36028797018963968,1\r\n";
  write_file(file, text + "\n" + rows(8, "1,1,2,1,1e3,1,0"));
  const auto queries = read_ccd_queries(file);
  ASSERT_EQ(queries.size(), 2u);
  EXPECT_EQ(queries[0].start[3], Vec3(0.75, -0.125, 0.1));
  EXPECT_EQ(queries[0].end[2], Vec3(1.5, -0.125, 0.1));
  EXPECT_EQ(queries[0].truth, true);
  EXPECT_EQ(queries[1].start[0], Vec3(1, 2, 1000));
  EXPECT_EQ(queries[1].truth, false);
  write_file(file, rows(8, "1,1,2,1,3,1"));
  EXPECT_EQ(read_ccd_queries(file)[0].truth, std::nullopt);
}

TEST(CcdQueries, ComplaintsNameThePlace) {
  expect_complaint("", ":", "no query");
  expect_complaint(rows(12, "1,1,2,1,3,1"), ":12:", "4 rows instead of 8");
  expect_complaint(rows(2, "1,1,2,1,3,1") + "1,1,x2,1,3,1\n", ":3:5:", "'x2'");
  expect_complaint(rows(2, "1,1,2,1,3,1") + "1,1,2,0,3,1\n", ":3:7:", "denominator of y is 0");
  expect_complaint("1,1,2,1,3\n", ":1:", "denominator of z");
  expect_complaint("1,1,2,1,3,1,0,5\n", ":1:15:", "more than 7");
  expect_complaint("1,1,2,1,3,1,2\n", ":1:13:", "0 or 1");
  expect_complaint("1,1,nan,1,3,1,1\n", ":1:5:", "finite");
  expect_complaint("1,1,2,1,1e300,1e-300,1\n", ":1:", "too large");
  expect_complaint(rows(3, "1,1,2,1,3,1,1") + "1,1,2,1,3,1,0\n", ":4:", "differs");
  expect_complaint(rows(8, "1,1,2,1,3,1,1") + rows(8, "1,1,2,1,3,1"), ":9:", "for all or for none");
  std::filesystem::remove(file);
  EXPECT_THROW(read_ccd_queries(file), InputError);
}

TEST(CcdQueries, ReadsTheDataSet) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "no ../shared/data and no $TAUT_DATA";
  std::size_t queries = 0;
  int hits = 0;
  for (const char* folder : {"ccd/unit-tests/vertex-face", "ccd/unit-tests/edge-edge"})
    for (const auto& entry : std::filesystem::directory_iterator(*data / folder))
      for (const CcdQuery& query : read_ccd_queries(entry.path())) {
        ++queries;
        ASSERT_TRUE(query.truth.has_value());
        hits += *query.truth;
      }
  EXPECT_EQ(queries, 324u);
  EXPECT_GT(hits, 50);
  EXPECT_LT(hits, 274);
}

}  // namespace taut
