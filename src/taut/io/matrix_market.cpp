#include "taut/io/matrix_market.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <utility>

#include "taut/io/text_cursor.h"
#include "taut/io/text_file.h"

namespace taut {

namespace {

std::string lower_case(std::string_view word) {
  std::string text(word);
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Adds up entries with the same row and column, in the order of the file.
void sort_and_add(std::vector<MatrixEntry>& entries) {
  const auto place = [](const MatrixEntry& e) { return std::pair(e.row, e.column); };
  const auto before = [&](const MatrixEntry& a, const MatrixEntry& b) {
    return place(a) < place(b);
  };
  if (!std::is_sorted(entries.begin(), entries.end(), before))
    std::stable_sort(entries.begin(), entries.end(), before);
  std::size_t last = 0;
  for (std::size_t k = 1; k < entries.size(); ++k) {
    if (place(entries[k]) == place(entries[last]))
      entries[last].value += entries[k].value;
    else
      entries[++last] = entries[k];
  }
  if (!entries.empty()) entries.resize(last + 1);
}

class MatrixMarketReader {
 public:
  MatrixMarketReader(std::string file, std::string_view text)
      : cursor_(std::move(file), text, false) {}

  MatrixMarket read() {
    read_banner();
    read_size();
    if (matrix_.dense)
      read_array();
    else
      read_coordinates();
    return std::move(matrix_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(cursor_.place(), message);
  }

  std::string banner_word(const char* what, const char* expected) {
    const std::string_view word = cursor_.word();
    if (word.empty())
      fail(std::string("the header ends before its ") + what + ", " + expected + " was expected");
    return lower_case(word);
  }
  [[noreturn]] void refuse_banner_word(const char* what, const std::string& word,
                                       const char* expected) const {
    fail(std::string("the ") + what + " is " + in_quotes(word) + ", " + expected + " was expected");
  }

  void read_banner() {
    const std::string mark = lower_case(cursor_.word());
    if (mark != "%%matrixmarket" && mark != "%matrixmarket")
      fail("the file begins with " + in_quotes(mark) +
           ", a Matrix Market file begins with %%MatrixMarket");
    const std::string object = banner_word("object", "matrix");
    if (object != "matrix" && object != "vector") refuse_banner_word("object", object, "matrix");
    vector_ = object == "vector";
    read_format();
    read_field();
    read_symmetry();
    if (!cursor_.at_line_end())
      fail("found " + in_quotes(cursor_.word()) +
           " after the header's symmetry, the end of the line was expected");
    cursor_.next_line();
  }

  void read_format() {
    constexpr const char* expected = "coordinate or array";
    const std::string format = banner_word("format", expected);
    if (format != "coordinate" && format != "array") refuse_banner_word("format", format, expected);
    matrix_.dense = format == "array";
  }

  void read_field() {
    constexpr const char* expected = "real, integer or pattern";
    const std::string field = banner_word("field", expected);
    if (field == "complex")
      fail("the matrix is complex, a real one was expected; write its real part");
    if (field != "real" && field != "double" && field != "integer" && field != "pattern")
      refuse_banner_word("field", field, expected);
    integer_ = field == "integer";
    pattern_ = field == "pattern";
    if (pattern_ && matrix_.dense)
      fail(
          "an array cannot be of field pattern (it would have no numbers); use coordinate pattern "
          "or array real");
  }

  void read_symmetry() {
    constexpr const char* expected = "general, symmetric or skew-symmetric";
    const std::string symmetry = banner_word("symmetry", expected);
    if (symmetry == "symmetric")
      matrix_.declared = MatrixSymmetry::symmetric;
    else if (symmetry == "skew-symmetric")
      matrix_.declared = MatrixSymmetry::skew_symmetric;
    else if (symmetry == "hermitian")
      fail("the matrix is Hermitian, which only complex ones are; a real matrix is symmetric");
    else if (symmetry != "general")
      refuse_banner_word("symmetry", symmetry, expected);
    if (pattern_ && matrix_.declared == MatrixSymmetry::skew_symmetric)
      fail("a pattern cannot be skew-symmetric, it has no signs");
    if (vector_ && !is_general()) fail("a vector cannot be " + symmetry + ", general was expected");
  }

  bool is_general() const { return matrix_.declared == MatrixSymmetry::general; }

  void read_size() {
    if (!cursor_.find_content('%')) {
      cursor_.word();
      fail("the file ends before the line with the matrix's size");
    }
    constexpr std::int64_t largest = std::numeric_limits<Index>::max();
    matrix_.rows = static_cast<Index>(count("the number of rows", largest));
    matrix_.columns = vector_ ? 1 : static_cast<Index>(count("the number of columns", largest));
    if (!is_general() && matrix_.rows != matrix_.columns)
      fail("the matrix has " + std::to_string(matrix_.rows) + " rows and " +
           std::to_string(matrix_.columns) +
           " columns, but was declared symmetric: the numbers must be equal");
    announced_ = matrix_.dense
                     ? array_count()
                     : count("the number of entries", std::numeric_limits<std::int64_t>::max());
    size_line_ = cursor_.line_of_word();
    end_line();
  }

  std::int64_t array_count() const {
    const std::int64_t rows = matrix_.rows, columns = matrix_.columns;
    if (is_general()) return rows * columns;
    return rows * (matrix_.declared == MatrixSymmetry::symmetric ? rows + 1 : rows - 1) / 2;
  }

  std::int64_t integer(const std::string& what) {
    const std::string_view word = cursor_.word();
    if (word.empty()) fail(what + " is missing; the line ends too early");
    std::int64_t value = 0;
    const NumberFault fault = parse_integer(word, value);
    if (fault == NumberFault::not_a_number)
      fail(what + " is " + in_quotes(word) + ", a whole number was expected");
    if (fault == NumberFault::too_large)
      fail(what + " is " + in_quotes(word) + ", which is too large");
    return value;
  }

  std::int64_t count(const std::string& what, std::int64_t largest) {
    const std::int64_t value = integer(what);
    if (value < 0) fail(what + " is " + std::to_string(value) + ", which is negative");
    if (value > largest)
      fail(what + " is " + std::to_string(value) + ", at most " + std::to_string(largest) +
           " can be read");
    return value;
  }

  Index index(const char* what, Index limit) {
    const std::int64_t value = integer(std::string("the ") + what + " index");
    if (value < 1 || value > limit)
      fail("the " + std::string(what) + " index is " + std::to_string(value) + ", 1 to " +
           std::to_string(limit) + " was expected");
    return static_cast<Index>(value - 1);
  }

  double value() {
    const std::string_view word = cursor_.word();
    if (word.empty()) fail("the value is missing; the line ends too early");
    std::int64_t whole = 0;
    if (integer_ && parse_integer(word, whole) == NumberFault::not_a_number)
      fail("the value is " + in_quotes(word) +
           ", a whole number was expected (the field is integer)");
    double number = 0;
    const NumberFault fault = parse_number(word, number);
    if (fault == NumberFault::not_a_number)
      fail("the value is " + in_quotes(word) + ", a number was expected");
    if (fault == NumberFault::too_large || !std::isfinite(number))
      fail("the value is " + in_quotes(word) + ", a finite number was expected");
    return number;
  }

  void end_line() {
    if (!cursor_.at_line_end())
      fail("found " + in_quotes(cursor_.word()) + ", the end of the line was expected");
    cursor_.next_line();
  }

  // Calls read_item for each announced entry; the file must hold neither fewer nor more.
  template <class ReadItem>
  void read_items(ReadItem read_item) {
    for (std::int64_t k = 0; k < announced_; ++k) {
      if (!cursor_.find_content('%')) {
        cursor_.word();
        fail("the file ends after " + std::to_string(k) + " entries, " +
             std::to_string(announced_) + " were announced in line " + std::to_string(size_line_));
      }
      read_item();
      end_line();
    }
    if (cursor_.find_content('%'))
      fail_at_next_word("more than the " + std::to_string(announced_) +
                        " entries announced in line " + std::to_string(size_line_));
  }
  [[noreturn]] void fail_at_next_word(const std::string& message) {
    cursor_.word();
    fail(message);
  }

  // What can be held by the bytes that are left, whatever was announced.
  std::size_t bounded_count(std::size_t bytes_of_item) const {
    return std::min(static_cast<std::size_t>(announced_), cursor_.bytes_left() / bytes_of_item + 1);
  }

  void read_coordinates() {
    matrix_.entries.reserve((is_general() ? 1 : 2) * bounded_count(vector_ || pattern_ ? 4 : 6));
    read_items([&] {
      const Index row = index("row", matrix_.rows);
      const Index column = vector_ ? 0 : index("column", matrix_.columns);
      check_triangle(row, column);
      const double entry = pattern_ ? 1.0 : value();
      add(row, column, entry);
    });
    sort_and_add(matrix_.entries);
  }

  void check_triangle(Index row, Index column) {
    if (is_general() || row == column) return;
    bool& here = row > column ? has_lower_ : has_upper_;
    here = true;
    if (has_lower_ && has_upper_)
      fail("the entry (" + std::to_string(row + 1) + ", " + std::to_string(column + 1) +
           ") lies in the other triangle than those before; a symmetric file holds one triangle, "
           "else declare it general");
  }

  void add(Index row, Index column, double entry) {
    const bool skew = matrix_.declared == MatrixSymmetry::skew_symmetric;
    if (skew && row == column && entry != 0)
      fail("the diagonal of a skew-symmetric matrix is zero, but this entry is not");
    matrix_.entries.push_back({row, column, entry});
    if (!is_general() && row != column)
      matrix_.entries.push_back({column, row, skew ? -entry : entry});
  }

  void read_array() {
    std::vector<double> stored;
    stored.reserve(bounded_count(2));
    read_items([&] { stored.push_back(value()); });
    if (is_general())
      matrix_.values = std::move(stored);
    else
      fill_both_triangles(stored);
  }

  void fill_both_triangles(const std::vector<double>& stored) {
    const bool skew = matrix_.declared == MatrixSymmetry::skew_symmetric;
    const std::size_t n = static_cast<std::size_t>(matrix_.rows);
    matrix_.values.assign(n * n, 0.0);
    auto next = stored.begin();
    for (std::size_t column = 0; column < n; ++column)
      for (std::size_t row = column + skew; row < n; ++row, ++next) {
        matrix_.values[column * n + row] = *next;
        matrix_.values[row * n + column] = skew ? -*next : *next;
      }
  }

  TextCursor cursor_;
  MatrixMarket matrix_;
  bool vector_ = false, integer_ = false, pattern_ = false;
  bool has_lower_ = false, has_upper_ = false;
  std::int64_t announced_ = 0;
  int size_line_ = 0;
};

}  // namespace

MatrixMarket read_matrix_market(const std::filesystem::path& path) {
  const std::string text = read_text_file(path);
  return MatrixMarketReader(path.string(), text).read();
}

std::vector<double> read_vector(const std::filesystem::path& path, Index rows) {
  MatrixMarket matrix = read_matrix_market(path);
  if (matrix.rows != rows || matrix.columns != 1)
    throw InputError({path.string()}, "holds " + std::to_string(matrix.rows) + " rows and " +
                                          std::to_string(matrix.columns) +
                                          " columns, a vector of " + std::to_string(rows) +
                                          " rows and 1 column was expected");
  if (matrix.dense) return std::move(matrix.values);
  std::vector<double> vector(static_cast<std::size_t>(rows), 0.0);
  for (const MatrixEntry& entry : matrix.entries) vector[entry.row] = entry.value;
  return vector;
}

}  // namespace taut
