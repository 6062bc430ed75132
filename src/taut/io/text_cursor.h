#pragma once
// Walks through a text file word by word and knows the line and column, so that every complaint can
// name its place.
//
// Lines end with LF, CRLF or CR; blanks are spaces, tabs, vertical tabs and form feeds. Numbers do
// not depend on the locale.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "taut/base/error.h"

namespace taut {

// `word` in quotation marks for a message: shortened to 40 characters, unprintable bytes as \xNN.
std::string in_quotes(std::string_view word);

enum class NumberFault { none, not_a_number, too_large };

// The whole word as a decimal number; a leading + is allowed, "nan" and "inf" are accepted, and
// what is too small becomes 0.
NumberFault parse_number(std::string_view word, double& value);
// The whole word as an integer.
NumberFault parse_integer(std::string_view word, std::int64_t& value);

class TextCursor {
 public:
  // With `continued_lines`, a backslash just before a line end joins the next line to this one
  // (OBJ). The text must outlive the cursor.
  TextCursor(std::string file, std::string_view text, bool continued_lines);

  bool at_end() const { return position_ >= text_.size(); }
  // True when nothing but blanks is left in this line.
  bool at_line_end();
  // The next word of this line; empty at its end.
  std::string_view word();
  // Goes to the next line; skip_comment before it keeps a backslash at the end of a comment from
  // joining lines.
  void next_line();
  void skip_comment();
  // A line with nothing but blanks, or a comment that begins with `mark`, is passed over; false
  // when none but such are left.
  bool find_content(char mark);

  // Where the last word began (or where one was missing).
  SourcePlace place() const { return {file_, word_line_, word_column_}; }
  int line_of_word() const { return word_line_; }
  int column_of_word() const { return word_column_; }
  const std::string& file() const { return file_; }
  std::size_t bytes_left() const { return text_.size() - position_; }

 private:
  void skip_blanks();
  std::size_t line_end_length(std::size_t at) const;
  bool continuation(std::size_t at) const {
    return continued_lines_ && text_[at] == '\\' && line_end_length(at + 1) > 0;
  }
  void pass_line_end(std::size_t length);

  std::string file_;
  std::string_view text_;
  bool continued_lines_;
  std::size_t position_ = 0;
  std::size_t line_start_ = 0;
  int line_ = 1;
  int word_line_ = 1;
  int word_column_ = 1;
};

}  // namespace taut
