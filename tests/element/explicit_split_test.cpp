#include "taut/element/explicit_split.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace taut {
namespace {

using Models = std::vector<std::unique_ptr<SpringModel>>;

Models one_model(ForceClass force_class, std::vector<Spring> springs) {
  Models models;
  models.push_back(
      std::make_unique<SpringModel>(force_class, SpringLawKind::linear, std::move(springs)));
  return models;
}

SpringParameters spring(double stiffness, double damping = 0.0) {
  return {.rest_length = 1.0, .stiffness = stiffness, .damping = damping};
}

Index count(const Models& models, bool explicitly) {
  Index sum = 0;
  for (const auto& model : models)
    if (model->stable_explicitly() == explicitly) sum += model->block_count();
  return sum;
}

// A ring of equal springs: each node has two, so that c/m may be 1/2.
Models ring(ForceClass force_class, Index nodes, const SpringParameters& p) {
  std::vector<Spring> springs;
  for (Index i = 0; i < nodes; ++i) springs.push_back({i, (i + 1) % nodes, p});
  return one_model(force_class, springs);
}

TEST(ExplicitSplit, UniformSpringsStayTogether) {
  const std::vector<double> masses(8, 0.01);
  const double h = 1e-3, limit = 0.5 * masses[0] / (h * h);
  Models weak = split_by_stability(ring(ForceClass::shear, 8, spring(0.999 * limit)), masses, h);
  EXPECT_EQ(weak.size(), 1u);
  EXPECT_EQ(count(weak, true), 8);
  Models strong = split_by_stability(ring(ForceClass::shear, 8, spring(1.001 * limit)), masses, h);
  EXPECT_EQ(strong.size(), 1u);
  EXPECT_EQ(count(strong, true), 0);
}

TEST(ExplicitSplit, DampingCountsTwice) {
  const std::vector<double> masses(8, 0.01);
  const double h = 1e-3, limit = 0.5 * masses[0] / (2.0 * h);
  EXPECT_EQ(
      count(split_by_stability(ring(ForceClass::bend, 8, spring(0.0, 0.999 * limit)), masses, h),
            true),
      8);
  EXPECT_EQ(
      count(split_by_stability(ring(ForceClass::bend, 8, spring(0.0, 1.001 * limit)), masses, h),
            true),
      0);
}

TEST(ExplicitSplit, StretchIsAlwaysImplicit) {
  const std::vector<double> masses(8, 0.01);
  EXPECT_EQ(
      count(split_by_stability(ring(ForceClass::stretch, 8, spring(1e-6)), masses, 1e-3), true), 0);
}

TEST(ExplicitSplit, LightNodesDecideForTheirSprings) {
  // 0 - 1 - 2 - 3, node 3 light: only its spring is implicit.
  const std::vector<double> masses{1.0, 1.0, 1.0, 1e-4};
  const double h = 0.1;
  const Models parts = split_by_stability(
      one_model(ForceClass::shear, {{0, 1, spring(1.0)}, {1, 2, spring(1.0)}, {2, 3, spring(1.0)}}),
      masses, h);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_FALSE(parts[0]->stable_explicitly());
  ASSERT_EQ(parts[0]->block_count(), 1);
  EXPECT_EQ(parts[0]->springs()[0].i, 2);
  EXPECT_EQ(parts[1]->block_count(), 2);
}

// What is promised: the sum at each node, whatever the strengths; and no spring is lost.
TEST(ExplicitSplit, SumsStayBelowOneOnRandomSprings) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-4.0, 1.0);
  const Index nodes = 60;
  std::vector<double> masses;
  for (Index i = 0; i < nodes; ++i) masses.push_back(std::pow(10.0, 0.3 * exponent(random)));
  const double h = 0.4;
  Models models;
  for (const ForceClass force_class : {ForceClass::stretch, ForceClass::shear, ForceClass::bend}) {
    std::vector<Spring> springs;
    for (int k = 0; k < 200; ++k) {
      const Index i = static_cast<Index>(random() % nodes),
                  j = static_cast<Index>((i + 1 + random() % (nodes - 1)) % nodes);
      springs.push_back(
          {i, j, spring(std::pow(10.0, exponent(random)), std::pow(10.0, exponent(random) - 2.0))});
    }
    models.push_back(
        std::make_unique<SpringModel>(force_class, SpringLawKind::linear, std::move(springs)));
  }
  const Models parts = split_by_stability(std::move(models), masses, h);
  EXPECT_EQ(count(parts, true) + count(parts, false), 600);
  EXPECT_GT(count(parts, true), 50);
  EXPECT_GT(count(parts, false), 250);
  std::vector<double> sum(nodes, 0.0);
  for (const auto& part : parts) {
    if (!part->stable_explicitly()) continue;
    EXPECT_NE(part->force_class(), ForceClass::stretch);
    for (const auto& [i, j, p] : part->springs()) {
      const double c = h * h * p.stiffness + 2.0 * h * p.damping;
      sum[i] += c / masses[i], sum[j] += c / masses[j];
    }
  }
  for (const double s : sum) EXPECT_LE(s, 1.0 + 1e-9);
}

}  // namespace
}  // namespace taut
