#include "taut/scene/toml_values.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace taut {

namespace {

template <class Items, class Write>
std::string joined(const Items& items, Write&& write) {
  std::string text = "[";
  for (const auto& item : items) text += (text.size() > 1 ? ", " : "") + write(item);
  return text + "]";
}

bool same_bits(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  for (int i = 0; i < 4; ++i)
    if (std::bit_cast<std::uint64_t>(a.coeffs()[i]) != std::bit_cast<std::uint64_t>(b.coeffs()[i]))
      return false;
  return true;
}

// A human wrote few digits: 30, not 30.000000000000004.
double few_digits(double value) { return std::stod(fmt::format("{:.12g}", value)); }

}  // namespace

std::string to_toml(double value) {
  if (value == 0.0) return std::signbit(value) ? "-0.0" : "0";
  return fmt::format("{}", value);
}

std::string to_toml(const std::string& value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text += '\\';
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7f)
      text += fmt::format("\\u{:04X}", code);
    else
      text += c;
  }
  return text + "\"";
}

std::string to_toml(const Vec3& value) {
  return joined(value, [](double x) { return to_toml(x); });
}

std::string to_toml(std::span<const Index> values) {
  return joined(values, [](Index i) { return std::to_string(i); });
}

std::string to_toml(std::span<const std::string> values) {
  return joined(values, [](const std::string& text) { return to_toml(text); });
}

std::string to_toml(const Eigen::Quaterniond& rotation) {
  const double length = rotation.vec().norm();
  const Vec3 axis = length > 0 ? Vec3(rotation.vec() / length) : Vec3::UnitZ();
  const double degrees = 2 * std::atan2(length, rotation.w()) * (180 / std::numbers::pi);
  const Vec3 round_axis = axis.unaryExpr(&few_digits);
  const std::pair<Vec3, double> candidates[] = {
      {round_axis, few_digits(degrees)}, {axis, few_digits(degrees)}, {axis, degrees}};
  for (const auto& [a, angle] : candidates)
    if (same_bits(rotation_about(a, angle), rotation))
      return fmt::format("{{ axis = {}, degrees = {} }}", to_toml(a), to_toml(angle));
  const std::vector<double> entries{rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  return "{ quaternion = " + joined(entries, [](double x) { return to_toml(x); }) + " }";
}

Eigen::Quaterniond rotation_about(const Vec3& axis, double degrees) {
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(degrees * (std::numbers::pi / 180), axis / axis.norm()));
}

}  // namespace taut
