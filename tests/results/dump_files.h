#pragma once
// A dump read back as dense matrices, and the cloth's forces worked out anew from springs.csv
// alone: code of the test's own, from the formulas.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "taut/io/matrix_market.h"

namespace taut::test {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

inline Matrix read_dense(const std::filesystem::path& path) {
  const MatrixMarket file = read_matrix_market(path);
  EXPECT_FALSE(file.dense) << path;
  Matrix m = Matrix::Zero(file.rows, file.columns);
  for (const MatrixEntry& e : file.entries) m(e.row, e.column) = e.value;
  return m;
}

inline Vector read_dense_vector(const std::filesystem::path& path) {
  const MatrixMarket file = read_matrix_market(path);
  EXPECT_TRUE(file.dense && file.columns == 1) << path;
  return Eigen::Map<const Vector>(file.values.data(),
                                  static_cast<Eigen::Index>(file.values.size()));
}

struct SpringRow {
  int i = 0, j = 0;
  std::string force_class;
  double rest_length = 0.0, stiffness = 0.0, damping = 0.0;
  bool implicit = true;  // told only where the class does not tell it
};

inline std::vector<SpringRow> read_springs(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  const std::string columns = "i,j,class,rest_length,stiffness,damping";
  const bool tells_implicit = line == columns + ",implicit";
  EXPECT_TRUE(tells_implicit || line == columns) << line;
  std::vector<SpringRow> springs;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    std::string field[7];
    for (std::string& f : field) std::getline(fields, f, ',');
    springs.push_back({std::stoi(field[0]), std::stoi(field[1]), field[2], std::stod(field[3]),
                       std::stod(field[4]), std::stod(field[5]),
                       !tells_implicit || field[6] == "1"});
  }
  return springs;
}

struct DumpFiles {
  explicit DumpFiles(const std::filesystem::path& f) : folder(f) {
    std::ifstream in(folder / "meta.json");
    meta = nlohmann::json::parse(in);
    a = matrix("A"), a_core = matrix("A_core"), s = matrix("S"), u = matrix("U");
    d_external = has("D_external") ? matrix("D_external") : Matrix::Zero(a.rows(), a.rows());
    m = vector("M"), b = vector("b"), z = vector("z"), x = vector("x"), v = vector("v"),
    f_start = vector("f"), dv = vector("dv");
    friction = has("friction") ? vector("friction") : Vector::Zero(a.rows());
    springs = read_springs(folder / "springs.csv");
  }
  bool has(const std::string& name) const {
    return std::filesystem::exists(folder / (name + ".mtx"));
  }
  Matrix matrix(const std::string& name) const { return read_dense(folder / (name + ".mtx")); }
  Vector vector(const std::string& name) const {
    return read_dense_vector(folder / (name + ".mtx"));
  }

  std::filesystem::path folder;
  nlohmann::json meta;
  Matrix a, a_core, s, u, d_external;
  Vector m, b, z, x, v, f_start, dv, friction;
  std::vector<SpringRow> springs;
};

struct Tension {
  double force = 0.0, slope = 0.0;
  bool slack = true;
};

// Choi & Ko 2002, type 2: bisection for u, a difference quotient for the slope, in extended
// precision.
inline long double buckled_force(double k, double l0, long double length) {
  long double low = 0.0L, high = 3.14159265358979323846L;
  for (int n = 0; n < 80; ++n) {
    const long double u = 0.5L * (low + high);
    (std::sin(u) / u > length / l0 ? low : high) = u;
  }
  const long double u = 0.5L * (low + high), curvature = 2.0L * u / l0;
  return k * curvature * curvature / (std::cos(u) - std::sin(u) / u);
}

inline Tension tension_of(const SpringRow& s, double length, const nlohmann::json& meta) {
  const double stretch = length - s.rest_length;
  if (s.force_class == "bend" && meta.at("bend_model") == "choi_ko") {
    const double cap = meta.at("cloths").at(0).at("bend_cap");
    if (stretch >= 0.0) return {cap * stretch, cap, false};
    const long double beam = buckled_force(s.stiffness, s.rest_length, length);
    if (beam < cap * stretch) return {cap * stretch, cap, false};
    const long double step = 1e-6L * s.rest_length;
    const long double slope = (buckled_force(s.stiffness, s.rest_length, length + step) -
                               buckled_force(s.stiffness, s.rest_length, length - step)) /
                              (2 * step);
    return {static_cast<double>(beam), static_cast<double>(slope), false};
  }
  if (stretch < 0.0 && s.force_class != "bend" && meta.at("compression") == "none") return {};
  return {s.stiffness * stretch, s.stiffness, false};
}

// K, D and force of the springs of one class at the dumped state; docs/mathematics.md, 2: K_s = T'
// e eᵀ + max(T/L, 0) (I - e eᵀ), D_s = k_d e eᵀ.
struct SpringSums {
  Matrix k, d;
  Vector f;
};

inline SpringSums sum_springs(const DumpFiles& dump, const std::string& force_class,
                              bool implicit_only = false) {
  const Eigen::Index n = dump.x.size();
  SpringSums sums{Matrix::Zero(n, n), Matrix::Zero(n, n), Vector::Zero(n)};
  const auto add = [](Matrix& to, int i, int j, const Mat3& block) {
    to.block<3, 3>(3 * i, 3 * i) += block, to.block<3, 3>(3 * j, 3 * j) += block;
    to.block<3, 3>(3 * i, 3 * j) -= block, to.block<3, 3>(3 * j, 3 * i) -= block;
  };
  for (const SpringRow& s : dump.springs) {
    if (s.force_class != force_class || (implicit_only && !s.implicit)) continue;
    const Vec3 d = dump.x.segment<3>(3 * s.j) - dump.x.segment<3>(3 * s.i),
               w = dump.v.segment<3>(3 * s.j) - dump.v.segment<3>(3 * s.i);
    const double length = d.norm();
    const Tension t = tension_of(s, length, dump.meta);
    if (t.slack) continue;
    const Vec3 e = d / length;
    const Mat3 along = e * e.transpose();
    add(sums.k, s.i, s.j,
        t.slope * along + std::max(t.force / length, 0.0) * (Mat3::Identity() - along));
    add(sums.d, s.i, s.j, s.damping * along);
    const Vec3 force = (t.force + s.damping * e.dot(w)) * e;
    sums.f.segment<3>(3 * s.i) += force, sums.f.segment<3>(3 * s.j) -= force;
  }
  return sums;
}

}  // namespace taut::test
