#pragma once
// Appends the shortest decimal that reads back to the same double (at most 17 significant digits)
// or float (9), whatever the locale.

#include <charconv>
#include <concepts>
#include <string>

namespace taut {

template <std::floating_point Number>
void append_decimal(std::string& text, Number value) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

}  // namespace taut
