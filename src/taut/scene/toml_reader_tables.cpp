#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "taut/base/error.h"
#include "taut/scene/toml_reader.h"
#include "taut/scene/toml_values.h"

namespace taut {

void TomlReader::inside_table(const toml::table& table, const std::string& path,
                              const std::function<void()>& inside) {
  levels_.push_back({&table, path, {}, complaints_.size()});
  inside();
  complain_of_unknown_keys();
  levels_.pop_back();
}

void TomlReader::table(const char* key, const KeyInfo& info, const std::function<void()>& inside) {
  const toml::node* node = take(key, info);
  if (!node) return;
  if (const toml::table* table = node->as_table())
    return inside_table(*table, level().path + key + ".", inside);
  const std::string name = level().path + key;
  wrong_type(*node, key,
             node->is_array_of_tables() ? "one table: write [" + name + "], with single brackets"
                                        : "a table [" + name + "]",
             info);
}

void TomlReader::tables(const char* key, const TableList& items, const KeyInfo& info) {
  const toml::node* node = take(key, info);
  if (!node) return;
  const toml::array* array = node->as_array();
  if (!array)
    return wrong_type(
        *node, key, fmt::format("a list of tables: write [[{}]], with double brackets", key), info);
  if (array->empty() && info.required)
    return complain(*node, key, fmt::format(" is missing; expected here: {}", info.doc));
  items.resize(array->size());
  for (std::size_t i = 0; i < array->size(); ++i) {
    const toml::node& entry = *array->get(i);
    if (!entry.is_table())
      return wrong_type(entry, key, fmt::format("a list of tables ([[{}]])", key), info);
    inside_table(*entry.as_table(), fmt::format("{}{}.{}.", level().path, key, i),
                 [&] { items.visit(i); });
  }
}

void TomlReader::complain_of_unknown_keys() {
  const std::vector<std::string>& known = level().known;
  for (const auto& [key, node] : *level().table) {
    const std::string name(key.str());
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string near = nearest_name(name, known), home = home_(name);
    std::string advice = "; the keys here are " + fmt::format("{}", fmt::join(known, ", "));
    if (!home.empty()) advice = "; " + home;
    if (!near.empty()) advice = "; did you mean '" + near + "'?";
    const std::string where = level().path.empty()
                                  ? "at the top level"
                                  : "in " + level().path.substr(0, level().path.size() - 1);
    complaints_.add(key.source(), "unknown key '" + name + "' " + where + advice);
  }
}

bool TomlReader::given(const char* key, bool) { return level().table->contains(key); }

void TomlReader::exactly_one(std::span<const char* const> keys) {
  std::vector<std::string> present;
  for (const char* key : keys)
    if (level().table->contains(key)) present.emplace_back(key);
  if (present.size() == 1) return;
  const std::string path =
      level().path.substr(0, level().path.empty() ? 0 : level().path.size() - 1);
  const std::string wanted = fmt::format("{} needs exactly one of {}", path, fmt::join(keys, ", "));
  if (present.empty())
    return complaints_.add(level().table->source(), wanted + ", it has none: add one");
  complaints_.add(
      level().table->find(std::string_view(present.back()))->first.source(),
      fmt::format("{}, it has {}: remove all but one", wanted, fmt::join(present, " and ")));
}

void TomlReader::check(bool holds, const char* key, const std::string& message) {
  if (holds || complaints_.size() > level().earlier_complaints) return;
  const toml::node* node = level().table->get(key);
  complain(node ? *node : *level().table, key, ": " + message);
}

void TomlReader::rotation(const char* key, Eigen::Quaterniond& value, const KeyInfo& info) {
  const toml::node* node = take(key, info);
  if (!node) return;
  constexpr const char* expected = "a table { axis = [x, y, z], degrees = angle }";
  if (!node->is_table()) return wrong_type(*node, key, expected, info);
  const bool as_quaternion = node->as_table()->contains("quaternion");
  const KeyInfo always{.required = true};
  inside_table(*node->as_table(), level().path + key + ".", [&] {
    if (as_quaternion) {
      double q[4] = {1, 0, 0, 0};
      if (const toml::node* entries = take("quaternion", always);
          !to_numbers("quaternion", *entries, q, always))
        return;
      const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
      check(std::abs(length - 1) < 1e-6, "quaternion",
            fmt::format("length {} found, 1 expected (w, x, y, z)", length));
      value = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
      // A written quaternion must come back to the last bit, so rounding in its length is left
      // alone.
      if (std::abs(length - 1) > 1e-14) value.coeffs() /= length;
      return;
    }
    Vec3 axis = Vec3::UnitZ();
    double degrees = 0.0;
    vector("axis", axis, {.doc = "the direction to turn about", .required = true});
    number("degrees", degrees,
           {.doc = "the angle, right-handed",
            .unit = "degrees",
            .min = -36000,
            .max = 36000,
            .required = true});
    check(axis.norm() > 0, "axis",
          "a direction was expected, the axis is zero; [0, 0, 1] turns about the vertical");
    if (axis.norm() > 0) value = rotation_about(axis, degrees);
  });
}

}  // namespace taut
