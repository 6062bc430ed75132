#include "taut/scene/toml_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "taut/base/error.h"

namespace taut {

namespace fs = std::filesystem;

namespace {

std::string hint(const KeyInfo& info) {
  return *info.hint ? std::string("; ") + info.hint : std::string();
}

}  // namespace

TomlReader::TomlReader(const toml::table& document, fs::path folder, Home home,
                       Complaints& complaints)
    : folder_(std::move(folder)), home_(std::move(home)), complaints_(complaints) {
  levels_.push_back({&document, "", {}, complaints.size()});
}

void TomlReader::complain(const toml::node& node, const char* key, const std::string& message) {
  complaints_.add(node.source(), level().path + key + message);
}

void TomlReader::wrong_type(const toml::node& node, const char* key, const std::string& expected,
                            const KeyInfo& info) {
  std::string advice;
  const auto text = node.value_exact<std::string>();
  const bool number_in_quotes =
      text && !text->empty() &&
      std::string("+-.0123456789").find(text->front()) != std::string::npos;
  if (number_in_quotes) advice = "; write the number without quotes and without a unit";
  complain(node, key, ": expected " + expected + ", found " + found(node) + advice + hint(info));
}

const toml::node* TomlReader::take(const char* key, const KeyInfo& info) {
  level().known.push_back(key);
  const auto entry = level().table->find(std::string_view(key));
  const bool present = entry != level().table->end();
  if (present) places_[level().path + key] = source_place(entry->second.source());
  if (present && info.applies) return &entry->second;
  // Whether a key applies depends on other keys: when one of those is wrong already, this complaint
  // would only mislead.
  const bool in_doubt = *info.only_for && complaints_.size() > level().earlier_complaints;
  if (in_doubt) return nullptr;
  if (present)
    complaints_.add(entry->first.source(), fmt::format("{}{} is only for {}: remove it",
                                                       level().path, key, info.only_for));
  else if (info.required && info.applies)
    complain(*level().table, key,
             fmt::format(" is missing; expected here: {}{}{}{}", info.doc,
                         *info.unit ? ", in " : "", info.unit, hint(info)));
  return nullptr;
}

bool TomlReader::in_range(const char* key, const toml::node& node, double value,
                          const KeyInfo& info) {
  const std::string problem = problem_of(value, info);
  if (!problem.empty()) complain(node, key, problem);
  return problem.empty();
}

bool TomlReader::to_number(const char* key, const toml::node& node, double& value,
                           const KeyInfo& info) {
  if (!node.is_number()) {
    wrong_type(node, key, *info.unit ? std::string("a number, in ") + info.unit : "a number", info);
    return false;
  }
  const double read = *node.value<double>();
  if (!in_range(key, node, read, info)) return false;
  value = read;
  return true;
}

bool TomlReader::to_integer(const char* key, const toml::node& node, int& value,
                            const KeyInfo& info) {
  const auto read = node.value_exact<std::int64_t>();
  if (!read) {
    wrong_type(node, key, "an integer", info);
    return false;
  }
  KeyInfo bounded = info;
  bounded.min = std::max<double>(info.min, std::numeric_limits<int>::min());
  bounded.max = std::min<double>(info.max, std::numeric_limits<int>::max());
  if (!in_range(key, node, static_cast<double>(*read), bounded)) return false;
  value = static_cast<int>(*read);
  return true;
}

bool TomlReader::to_numbers(const char* key, const toml::node& node, std::span<double> values,
                            const KeyInfo& info) {
  const toml::array* array = node.as_array();
  if (!array || array->size() != values.size()) {
    wrong_type(node, key,
               fmt::format("an array of {} numbers{}{}", values.size(), *info.unit ? ", in " : "",
                           info.unit),
               info);
    return false;
  }
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!to_number(key, *array->get(i), values[i], info)) return false;
  return true;
}

void TomlReader::number(const char* key, double& value, const KeyInfo& info) {
  if (const toml::node* node = take(key, info)) to_number(key, *node, value, info);
}

void TomlReader::integer(const char* key, int& value, const KeyInfo& info) {
  if (const toml::node* node = take(key, info)) to_integer(key, *node, value, info);
}

void TomlReader::flag(const char* key, bool& value, const KeyInfo& info) {
  const toml::node* node = take(key, info);
  if (!node) return;
  if (const auto read = node->value_exact<bool>())
    value = *read;
  else
    wrong_type(*node, key, "true or false", info);
}

void TomlReader::text(const char* key, std::string& value, const KeyInfo& info) {
  const toml::node* node = take(key, info);
  if (!node) return;
  if (const auto read = node->value_exact<std::string>())
    value = *read;
  else
    wrong_type(*node, key, "a text in quotes", info);
}

void TomlReader::file(const char* key, fs::path& value, const KeyInfo& info) {
  std::string name;
  const toml::node* node = level().table->get(key);
  text(key, name, info);
  if (name.empty()) {
    const auto given = node ? node->value_exact<std::string>() : std::nullopt;
    if (info.applies && given && given->empty())
      complain(*node, key, ": a file name was expected, the text is empty");
    return;
  }
  value = (folder_ / name).lexically_normal();
  std::error_code failure;
  if (!fs::exists(value, failure))
    complain(
        *node, key,
        fmt::format(": there is no file '{}'; a relative name starts at the scene file's folder",
                    value.string()));
  else if (!fs::is_regular_file(value, failure))
    complain(*node, key, fmt::format(": '{}' is not a file", value.string()));
}

void TomlReader::vector(const char* key, Vec3& value, const KeyInfo& info) {
  Vec3 read = value;
  const toml::node* node = take(key, info);
  if (node && to_numbers(key, *node, {read.data(), 3}, info)) value = read;
}

void TomlReader::integers(const char* key, std::vector<Index>& value, const KeyInfo& info) {
  const toml::node* node = take(key, info);
  if (!node) return;
  const toml::array* array = node->as_array();
  if (!array || (info.count && array->size() != info.count))
    return wrong_type(
        *node, key,
        info.count ? fmt::format("an array of {} integers", info.count) : "an array of integers",
        info);
  std::vector<Index> read(array->size());
  for (std::size_t i = 0; i < read.size(); ++i)
    if (!to_integer(key, *array->get(i), read[i], info)) return;
  value = read;
}

int TomlReader::index_of(const char* key, const toml::node& node,
                         std::span<const char* const> names) {
  const auto word = node.value_exact<std::string>();
  if (!word) {
    wrong_type(node, key, fmt::format("one of \"{}\"", fmt::join(names, "\", \"")), {});
    return -1;
  }
  const auto place = std::find(names.begin(), names.end(), *word);
  if (place != names.end()) return static_cast<int>(place - names.begin());
  complain(node, key, unknown_name(*word, names));
  return -1;
}

void TomlReader::choose(const char* key, int& value, std::span<const char* const> names,
                        const KeyInfo& info) {
  const toml::node* node = take(key, info);
  const int index = node ? index_of(key, *node, names) : -1;
  if (index >= 0) value = index;
}

void TomlReader::choose_some(const char* key, std::vector<std::string>& value,
                             std::span<const char* const> names, const KeyInfo& info) {
  const toml::node* node = take(key, info);
  if (!node) return;
  const toml::array* array = node->as_array();
  if (!array)
    return wrong_type(
        *node, key, fmt::format("an array with some of \"{}\"", fmt::join(names, "\", \"")), info);
  for (const toml::node& entry : *array) {
    const int index = index_of(key, entry, names);
    if (index < 0) return;
    const std::string name = names[static_cast<std::size_t>(index)];
    if (std::find(value.begin(), value.end(), name) != value.end())
      return complain(entry, key, ": \"" + name + "\" stands here twice");
    value.push_back(name);
  }
}

}  // namespace taut
