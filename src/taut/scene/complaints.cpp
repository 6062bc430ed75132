#include "taut/scene/complaints.h"

#include <fmt/format.h>

#include <algorithm>

#include "taut/base/error.h"

namespace taut {

namespace {

std::string advice(const std::string& problem) {
  const auto says = [&](const char* words) { return problem.find(words) != std::string::npos; };
  if (says("cannot redefine existing table"))
    return "; a table's keys all stand below one [header]; several of a kind are [[double "
           "brackets]]";
  if (says("cannot redefine existing array")) return "; write [[double brackets]] each time";
  if (says("cannot redefine")) return "; the key stands here a second time: remove one of the two";
  if (says("expected digit") || says("decimal integer") || says("floating-point"))
    return "; a number stands without a unit (5 ms is 5e-3), a text in quotes";
  if (says("end-of-file"))
    return "; something was opened that is never closed, or a value is missing";
  if (says("inline table")) return "; { ... } stands on one line, parts separated by commas";
  if (says("value type") || says("key-value pair"))
    return "; a line reads key = value, and a text stands in quotes";
  return "";
}

}  // namespace

SourcePlace source_place(const toml::source_region& where) {
  const std::string file = where.path ? *where.path : std::string();
  if (file.starts_with("--set")) return {file};
  return {file, static_cast<int>(where.begin.line), static_cast<int>(where.begin.column)};
}

std::string located(const toml::source_region& where, const std::string& message) {
  return located(source_place(where), message);
}

void Complaints::add(const toml::source_region& where, const std::string& message) {
  // Changes from the command line come after those of the file.
  const bool setting = where.path && where.path->starts_with("--set");
  const toml::source_position last{~toml::source_index{0}, ~toml::source_index{0}};
  Complaint complaint{setting ? last : where.begin, located(where, message)};
  // One --set may spoil many entries in the same way.
  for (const Complaint& other : all_)
    if (other.text == complaint.text) return;
  all_.push_back(std::move(complaint));
}

void Complaints::throw_if_any() const {
  if (all_.empty()) return;
  std::vector<Complaint> sorted = all_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Complaint& a, const Complaint& b) { return a.at < b.at; });
  std::string text;
  for (std::size_t i = 0; i < std::min(sorted.size(), max_shown); ++i)
    text += (i ? "\n" : "") + sorted[i].text;
  if (sorted.size() > max_shown) text += fmt::format("\nand {} more", sorted.size() - max_shown);
  throw InputError(text);
}

std::string found(const toml::node& value) {
  if (const auto text = value.value_exact<std::string>())
    return "the text \"" + text->substr(0, 60) + "\"";
  if (const auto integer = value.value_exact<std::int64_t>())
    return fmt::format("the integer {}", *integer);
  if (const auto number = value.value_exact<double>()) return fmt::format("the number {}", *number);
  if (const auto flag = value.value_exact<bool>()) return *flag ? "true" : "false";
  if (const toml::array* array = value.as_array())
    return fmt::format("an array of {}", array->size());
  return value.is_table() ? "a table" : "a date or time";
}

std::string syntax_problem(const toml::parse_error& error) {
  std::string problem(error.description());
  constexpr std::string_view opening = "Error while parsing ";
  if (problem.starts_with(opening)) problem = "in " + problem.substr(opening.size());
  return "not valid TOML: " + problem + advice(problem);
}

}  // namespace taut
