#include "taut/element/explicit_split.h"

#include <algorithm>

namespace taut {

namespace {

constexpr double largest_sum = 1.0;
// Springs that are alike but for rounding are alike.
constexpr double alike = 1.0 + 1e-9;

bool always_implicit(const SpringModel& model) {
  return model.force_class() == ForceClass::stretch;
}

// Of each node: the largest share c/m that its explicit springs may have.
std::vector<double> thresholds(const std::vector<std::unique_ptr<SpringModel>>& models,
                               const std::vector<std::vector<double>>& coefficients,
                               std::span<const double> masses) {
  std::vector<std::vector<double>> shares(masses.size());
  for (std::size_t m = 0; m < models.size(); ++m) {
    if (always_implicit(*models[m])) continue;
    const auto springs = models[m]->springs();
    for (std::size_t s = 0; s < springs.size(); ++s)
      for (const Index node : {springs[s].i, springs[s].j})
        shares[node].push_back(coefficients[m][s] / masses[node]);
  }
  std::vector<double> threshold(masses.size(), 0.0);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    std::ranges::sort(shares[i]);
    double sum = 0.0;
    for (std::size_t k = 0; k < shares[i].size();) {
      std::size_t end = k;
      for (; end < shares[i].size() && shares[i][end] <= alike * shares[i][k]; ++end)
        sum += shares[i][end];
      if (sum > largest_sum) break;
      threshold[i] = shares[i][end - 1];
      k = end;
    }
  }
  return threshold;
}

}  // namespace

std::vector<std::unique_ptr<SpringModel>> split_by_stability(
    std::vector<std::unique_ptr<SpringModel>> models, std::span<const double> masses, double h) {
  std::vector<std::vector<double>> coefficients;
  for (const auto& model : models) {
    coefficients.emplace_back(static_cast<std::size_t>(model->block_count()));
    model->bound_blocks(h * h, 2.0 * h, coefficients.back());
  }
  const std::vector<double> threshold = thresholds(models, coefficients, masses);

  std::vector<std::unique_ptr<SpringModel>> parts;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const SpringModel& model = *models[m];
    std::vector<Spring> implicit, stable;
    for (std::size_t s = 0; s < model.springs().size(); ++s) {
      const Spring& spring = model.springs()[s];
      const auto weak_at = [&](Index node) {
        return coefficients[m][s] / masses[node] <= threshold[node];
      };
      const bool is_stable = !always_implicit(model) && weak_at(spring.i) && weak_at(spring.j);
      (is_stable ? stable : implicit).push_back(spring);
    }
    if (!implicit.empty())
      parts.push_back(
          std::make_unique<SpringModel>(model.force_class(), model.law(), std::move(implicit)));
    if (!stable.empty()) {
      parts.push_back(
          std::make_unique<SpringModel>(model.force_class(), model.law(), std::move(stable)));
      parts.back()->mark_stable_explicitly();
    }
  }
  return parts;
}

}  // namespace taut
