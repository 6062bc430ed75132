#pragma once
// Appends the shortest decimal that reads back to the same double (at most 17 significant digits), whatever the locale.

#include <charconv>
#include <string>

namespace taut {

inline void append_decimal(std::string& text, double value) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

}  // namespace taut
