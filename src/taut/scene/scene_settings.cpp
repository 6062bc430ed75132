#include "taut/scene/scene_settings.h"

#include <fmt/format.h>

#include <charconv>
#include <vector>

#include "taut/base/error.h"
#include "taut/scene/complaints.h"
#include "taut/scene/toml_values.h"

namespace taut {

namespace {

struct Setting {
  std::string place;  // "--set key=value", the file name of what it adds
  std::vector<std::string> path;
  std::string value;
};

[[noreturn]] void refuse(const std::string& place, const std::string& why) {
  throw InputError({place}, why);
}

std::vector<std::string> split(const std::string& path, const std::string& place) {
  std::vector<std::string> parts{""};
  for (const char c : path) {
    if (c == '.')
      parts.emplace_back();
    else
      parts.back().push_back(c);
  }
  for (const std::string& part : parts)
    if (part.empty()) refuse(place, "a part of the key is empty: write it as in solver.name=mpcg");
  return parts;
}

Setting parse_setting(const std::string& text) {
  const std::string place = "--set " + text;
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) refuse(place, "expected key=value, as in time.step=2e-3");
  if (equals + 1 == text.size())
    refuse(place, "there is no value after '='; an empty text is '\"\"'");
  return {place, split(text.substr(0, equals), place), text.substr(equals + 1)};
}

// A table with the value under "v": nodes can be moved out of it without losing their places.
toml::table parse_value(const Setting& setting) {
  try {
    return toml::parse("v = " + setting.value, setting.place);
  } catch (const toml::parse_error& error) {
    // A bare word is a text: shells eat quotes.
    if (std::string("[{\"'").find(setting.value.front()) == std::string::npos)
      return toml::parse("v = " + to_toml(setting.value), setting.place);
    refuse(setting.place, "the value is " + syntax_problem(error));
  }
}

// Moves the "v" of `parsed` into `table`, its key placed where the value is.
void insert(toml::table& table, const std::string& name, toml::table parsed) {
  toml::node& value = *parsed.get("v");
  const toml::key key(name, toml::source_region(value.source()));
  table.erase(name);
  table.insert(key, std::move(value));
}

void assign(toml::table& table, const Setting& setting, std::size_t depth);

void assign_entries(toml::array& array, const Setting& setting, std::size_t depth) {
  const std::string& part = setting.path[depth];
  std::size_t index = 0;
  const auto [end, failure] = std::from_chars(part.data(), part.data() + part.size(), index);
  const bool numbered = failure == std::errc() && end == part.data() + part.size();
  const std::string list = fmt::format("{}", setting.path[depth - 1]);
  if (numbered && index >= array.size())
    refuse(setting.place, fmt::format("there is no number {} in '{}', which has {}, counted from 0",
                                      index, list, array.size()));
  if (numbered && depth + 1 == setting.path.size())
    refuse(setting.place, "name a key of this entry, as in cloth.0.k_stretch=600");
  if (!numbered && array.empty())
    refuse(setting.place, "'" + list + "' has no entries that could be changed");
  for (std::size_t i = 0; i < array.size(); ++i) {
    if (numbered && i != index) continue;
    toml::table* entry = array.get(i)->as_table();
    if (!entry)
      refuse(
          setting.place,
          fmt::format("'{}' is not a list of tables: set it as a whole, as in gravity=[0,0,-1.6]",
                      list));
    assign(*entry, setting, depth + (numbered ? 1 : 0));
  }
}

void assign(toml::table& table, const Setting& setting, std::size_t depth) {
  const std::string& name = setting.path[depth];
  if (depth + 1 == setting.path.size()) return insert(table, name, parse_value(setting));
  toml::node* next = table.get(name);
  if (next && next->is_array()) return assign_entries(*next->as_array(), setting, depth + 1);
  if (next && !next->is_table())
    refuse(setting.place, "'" + name + "' holds a value, it has no keys below it");
  if (!next && (name == "cloth" || name == "solid" || name == "pin" || name == "key_frames"))
    refuse(setting.place, "the scene has no '" + name + "' that could be changed");
  if (!next) insert(table, name, toml::parse("v = {}", setting.place));
  assign(*table.get(name)->as_table(), setting, depth + 1);
}

}  // namespace

void apply_setting(toml::table& document, const std::string& setting) {
  assign(document, parse_setting(setting), 0);
}

}  // namespace taut
