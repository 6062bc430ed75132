#include "taut/io/ccd_queries.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "taut/io/text_cursor.h"
#include "taut/io/text_file.h"

namespace taut {

namespace {

constexpr std::string_view blanks = " \t\r\v\f";

class RowReader {
 public:
  RowReader(std::string file, std::string_view line, int number)
      : file_(std::move(file)), line_(line), number_(number) {}

  // The next column, without blanks around it; at the end of the line there is none.
  std::optional<std::string_view> column() {
    if (next_ > line_.size()) return std::nullopt;
    const std::size_t begin = next_, end = std::min(line_.find(',', begin), line_.size());
    next_ = end + 1;
    column_ = begin;
    std::string_view word = line_.substr(begin, end - begin);
    const std::size_t first = word.find_first_not_of(blanks);
    if (first == word.npos) return std::string_view();
    column_ += first;
    return word.substr(first, word.find_last_not_of(blanks) + 1 - first);
  }

  double number(const char* what) {
    const auto word = column();
    if (!word)
      fail(
          fmt::format("the row ends where {} is expected: a row has 6 columns "
                      "num,den,num,den,num,den and perhaps a 7th",
                      what));
    double value = 0.0;
    if (word->empty() || parse_number(*word, value) != NumberFault::none || !std::isfinite(value))
      fail(fmt::format("found {} where {} is expected, a finite decimal number", in_quotes(*word),
                       what));
    return value;
  }

  double coordinate(char axis) {
    const double numerator = number(fmt::format("the numerator of {}", axis).c_str());
    const double denominator = number(fmt::format("the denominator of {}", axis).c_str());
    if (denominator == 0.0) fail(fmt::format("the denominator of {} is 0", axis));
    const double value = numerator / denominator;
    if (!std::isfinite(value))
      fail(fmt::format("{} = {:g} / {:g} is too large", axis, numerator, denominator));
    return value;
  }

  std::optional<bool> truth() {
    const auto word = column();
    if (!word) return std::nullopt;
    if (*word != "0" && *word != "1")
      fail(fmt::format("found {} in column 7, where the true answer 0 or 1 is expected",
                       in_quotes(*word)));
    return *word == "1";
  }

  void finish() {
    if (column())
      fail("the row has more than 7 columns: num,den,num,den,num,den and the true answer");
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw InputError({file_, number_, static_cast<int>(column_) + 1}, message);
  }

 private:
  std::string file_;
  std::string_view line_;
  int number_;
  std::size_t next_ = 0, column_ = 0;
};

void read_row(RowReader& row, int corner, bool first_query, std::vector<CcdQuery>& queries) {
  CcdQuery& query = queries.back();
  Vec3& x = corner < 4 ? query.start[corner] : query.end[corner - 4];
  for (int i = 0; i < 3; ++i) x[i] = row.coordinate("xyz"[i]);
  const std::optional<bool> truth = row.truth();
  row.finish();
  if (corner == 0) query.truth = truth;
  if (truth != query.truth)
    row.fail(
        "the true answer differs from that of the first row of this query: all eight rows of a "
        "query have the same");
  if (!first_query && truth.has_value() != queries.front().truth.has_value())
    row.fail(
        "some queries have a 7th column with the true answer and some have none: give it for all "
        "or for none");
}

}  // namespace

std::vector<CcdQuery> read_ccd_queries(const std::filesystem::path& path) {
  const std::string text = read_text_file(path);
  std::vector<CcdQuery> queries;
  int line_number = 0, corner = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    ++line_number;
    if (line.find_first_not_of(blanks) == line.npos) continue;
    if (corner == 0) queries.emplace_back();
    RowReader row(path.string(), line, line_number);
    read_row(row, corner, queries.size() == 1, queries);
    corner = (corner + 1) % 8;
  }
  if (corner != 0)
    throw InputError(
        {path.string(), line_number, 0},
        fmt::format("the last query has {} rows instead of 8: four corners at the start and the "
                    "same four at the end; complete it or remove it",
                    corner));
  if (queries.empty())
    throw InputError({path.string(), 0, 0},
                     "there is no query in this file: eight rows num,den,num,den,num,den are one");
  return queries;
}

}  // namespace taut
