#pragma once
// Values as TOML text that reads back to the same bits: shortest decimals, escaped texts.

#include <Eigen/Geometry>
#include <span>
#include <string>

#include "taut/base/types.h"

namespace taut {

std::string to_toml(double value);
std::string to_toml(const std::string& value);
std::string to_toml(const Vec3& value);
std::string to_toml(std::span<const Index> values);
std::string to_toml(std::span<const std::string> values);
// { axis = [...], degrees = ... } where that gives the same bits, else { quaternion = [w, x, y, z]
// }.
std::string to_toml(const Eigen::Quaterniond& rotation);

// The rotation by `degrees` about `axis` (any length > 0), right-handed.
Eigen::Quaterniond rotation_about(const Vec3& axis, double degrees);

}  // namespace taut
