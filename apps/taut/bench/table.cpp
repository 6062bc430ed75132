#include "bench/table.h"

#include <fmt/format.h>

#include <algorithm>

namespace taut::app {

namespace {

// Columns a terminal shows for UTF-8 text (no wide characters are used).
std::size_t shown_width(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](unsigned char c) { return (c & 0xC0) != 0x80; }));
}

bool looks_numeric(const std::string& text) {
  return !text.empty() &&
         (std::isdigit(static_cast<unsigned char>(text[0])) || text[0] == '-' || text[0] == '.');
}

}  // namespace

std::string TextTable::text() const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_)
    for (std::size_t c = 0; c < row.size(); ++c)
      widths[c] = std::max(widths[c], shown_width(row[c]));
  std::size_t total = 0;
  for (const std::size_t w : widths) total += w + 2;
  std::string out;
  const auto rule = [&] { out += std::string(total - 2, '-') + "\n"; };
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const auto& row = rows_[r];
    if (row.empty()) {
      rule();
      continue;
    }
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string pad(widths[c] - shown_width(row[c]), ' ');
      line += (looks_numeric(row[c]) ? pad + row[c] : row[c] + pad) + "  ";
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
    if (r == 0) rule();
  }
  return out;
}

}  // namespace taut::app
