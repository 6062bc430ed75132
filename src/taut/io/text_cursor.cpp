#include "taut/io/text_cursor.h"

#include <algorithm>
#include <charconv>

namespace taut {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view without_plus(std::string_view word) {
  // "+-1" must stay wrong.
  const bool plus = word.size() > 1 && word[0] == '+' && (is_digit(word[1]) || word[1] == '.');
  return plus ? word.substr(1) : word;
}

// Whether a decimal number outside the range of double is beyond its large end: the sign of its
// decimal exponent.
bool is_huge(std::string_view word) {
  const std::size_t exponent_mark = std::min(word.find_first_of("eE"), word.size());
  const std::string_view mantissa = word.substr(0, exponent_mark);
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t leading = std::min(mantissa.find_first_of("123456789"), mantissa.size());
  std::int64_t power = static_cast<std::int64_t>(point) - static_cast<std::int64_t>(leading);
  if (exponent_mark < word.size()) {
    std::int64_t exponent = 0;
    const std::string_view digits = without_plus(word.substr(exponent_mark + 1));
    if (std::from_chars(digits.data(), digits.data() + digits.size(), exponent).ec ==
        std::errc::result_out_of_range)
      return digits[0] != '-';
    power += exponent;
  }
  return power > 0;
}

}  // namespace

std::string in_quotes(std::string_view word) {
  constexpr std::size_t longest = 40;
  constexpr char hex[] = "0123456789abcdef";
  std::string text = "'";
  for (const char c : word.substr(0, longest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f)
      text += {'\\', 'x', hex[byte >> 4], hex[byte & 15]};
    else
      text += c;
  }
  return text + (word.size() > longest ? "...'" : "'");
}

NumberFault parse_number(std::string_view word, double& value) {
  const std::string_view digits = without_plus(word);
  const char* const end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value);
  if (error == std::errc::invalid_argument || stop != end) return NumberFault::not_a_number;
  if (error == std::errc{}) return NumberFault::none;
  if (is_huge(digits)) return NumberFault::too_large;
  value = 0;
  return NumberFault::none;
}

NumberFault parse_integer(std::string_view word, std::int64_t& value) {
  const std::string_view digits = without_plus(word);
  const char* const end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value);
  if (error == std::errc::invalid_argument || stop != end) return NumberFault::not_a_number;
  return error == std::errc{} ? NumberFault::none : NumberFault::too_large;
}

TextCursor::TextCursor(std::string file, std::string_view text, bool continued_lines)
    : file_(std::move(file)), text_(text), continued_lines_(continued_lines) {}

std::size_t TextCursor::line_end_length(std::size_t at) const {
  if (at >= text_.size()) return 0;
  if (text_[at] == '\n') return 1;
  if (text_[at] != '\r') return 0;
  return at + 1 < text_.size() && text_[at + 1] == '\n' ? 2 : 1;
}

void TextCursor::pass_line_end(std::size_t length) {
  position_ += length;
  line_start_ = position_;
  ++line_;
}

void TextCursor::skip_blanks() {
  while (!at_end()) {
    if (is_blank(text_[position_]))
      ++position_;
    else if (continuation(position_))
      pass_line_end(1 + line_end_length(position_ + 1));
    else
      return;
  }
}

bool TextCursor::at_line_end() {
  skip_blanks();
  return at_end() || line_end_length(position_) > 0;
}

std::string_view TextCursor::word() {
  skip_blanks();
  word_line_ = line_;
  word_column_ = static_cast<int>(position_ - line_start_) + 1;
  const std::size_t begin = position_;
  while (!at_end() && !is_blank(text_[position_]) && line_end_length(position_) == 0 &&
         !continuation(position_))
    ++position_;
  return text_.substr(begin, position_ - begin);
}

bool TextCursor::find_content(char mark) {
  for (; !at_end(); next_line())
    if (!at_line_end() && text_[position_] != mark) return true;
  return false;
}

void TextCursor::skip_comment() {
  while (!at_end() && line_end_length(position_) == 0) ++position_;
}

void TextCursor::next_line() {
  while (!at_end() && line_end_length(position_) == 0) {
    if (continuation(position_))
      pass_line_end(1 + line_end_length(position_ + 1));
    else
      ++position_;
  }
  if (!at_end()) pass_line_end(line_end_length(position_));
}

}  // namespace taut
