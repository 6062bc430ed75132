// The bulk evaluation of springs against spring_response, the readable form of the same law.

#include "taut/element/spring_model.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "element/random_springs.h"

namespace taut {
namespace {

constexpr std::array laws{SpringLawKind::linear, SpringLawKind::buckling, SpringLawKind::choi_ko};

struct Sample {
  explicit Sample(SpringLawKind law, Index count = 300) {
    test::Random random(7);
    x = random.vectors(40, 1.0), v = random.vectors(40, 3.0), p = random.vectors(40, 2.0),
    q = random.vectors(40, 5.0);
    x[1] = x[0];
    model = std::make_unique<SpringModel>(ForceClass::shear, law,
                                          test::random_springs(random, x, count));
  }
  std::vector<Vec3> x, v, p, q;
  std::unique_ptr<SpringModel> model;
};

TEST(SpringModel, EqualsTheSpringLawForAllRequests) {
  for (const SpringLawKind law : laws) {
    const Sample sample(law);
    for (int combination = 0; combination < 32; ++combination) {
      ForceRequest request;
      request.x = sample.x, request.v = sample.v;
      request.matrix_stiffness = combination & 1 ? 0.37 : 0.0;
      request.matrix_damping = combination & 2 ? 1.9 : 0.0;
      request.force = combination & 4 ? -0.8 : 0.0;
      if (combination & 8) request.stiffness_operand = sample.p;
      if (combination & 16) request.damping_operand = sample.q;
      const double untouched = 123.0;
      std::vector<double> blocks(9 * static_cast<std::size_t>(sample.model->block_count()),
                                 untouched);
      std::vector<Vec3> vectors(static_cast<std::size_t>(sample.model->vector_count()),
                                Vec3::Constant(untouched));
      sample.model->evaluate(request, blocks, vectors);
      for (std::size_t s = 0; s < vectors.size(); ++s) {
        const auto& [i, j, parameters] = sample.model->springs()[s];
        const SpringResponse r =
            spring_response(law, parameters, sample.x[j] - sample.x[i], sample.v[j] - sample.v[i]);
        Vec3 g = request.force * r.force;
        if (combination & 8) g += r.stiffness * (sample.p[i] - sample.p[j]);
        if (combination & 16) g += r.damping * (sample.q[i] - sample.q[j]);
        const Mat3 expected =
            request.matrix_stiffness * r.stiffness + request.matrix_damping * r.damping;
        const double size = r.force.norm() + 4.0 * r.stiffness.norm() + 10.0 * r.damping.norm();
        EXPECT_LE((vectors[s] - g).norm(), 1e-13 * size)
            << "spring " << s << ", request " << combination;
        for (int e = 0; e < 9; ++e) {
          const double wanted = request.wants_matrix() ? expected(e / 3, e % 3) : untouched;
          EXPECT_NEAR(blocks[9 * s + static_cast<std::size_t>(e)], wanted,
                      request.wants_matrix() ? 1e-13 * size : 0.0);
        }
      }
    }
  }
}

TEST(SpringModel, EnergyIsTheSumAndCollapsedSpringsAreCounted) {
  for (const SpringLawKind law : laws) {
    const Sample sample(law);
    double energy = 0.0;
    Index collapsed = 0;
    for (const auto& [i, j, p] : sample.model->springs()) {
      energy += spring_response(law, p, sample.x[j] - sample.x[i], Vec3::Zero()).energy;
      collapsed += i + j == 1 ? 1 : 0;
    }
    EXPECT_NEAR(sample.model->energy(sample.x), energy, 1e-11 * energy);
    EXPECT_GT(collapsed, 40);
    EXPECT_EQ(sample.model->collapsed(sample.x), collapsed);
  }
}

// Adds up what `connect` says, as the assembler would.
struct Sums : ConnectionSink {
  std::span<const Vec3> vectors;
  std::vector<Vec3> at_node;
  void matrix(Index, Index, Index, int, bool) override {}
  void vector(Index id, Index node, int sign) override { at_node[node] += sign * vectors[id]; }
};

TEST(SpringModel, InnerForcesHaveNoSumAndNoTorque) {
  for (const SpringLawKind law : laws) {
    const Sample sample(law);
    ForceRequest request;
    request.x = sample.x, request.v = sample.v;
    std::vector<Vec3> vectors(static_cast<std::size_t>(sample.model->vector_count()));
    sample.model->evaluate(request, {}, vectors);
    Sums sums;
    sums.vectors = vectors;
    sums.at_node.assign(sample.x.size(), Vec3::Zero());
    sample.model->connect(sums);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    double size = 0.0;
    for (std::size_t i = 0; i < sample.x.size(); ++i) {
      force += sums.at_node[i];
      torque += sample.x[i].cross(sums.at_node[i]);
      size += sums.at_node[i].norm();
    }
    EXPECT_GT(size, 1.0);
    EXPECT_LT(force.norm(), 1e-13 * size);
    EXPECT_LT(torque.norm(), 1e-13 * size);
  }
}

// The crossing of beam and line is found once for springs alike; it must be every spring's own all
// the same.
TEST(SpringModel, EverySpringHasItsOwnBeamRange) {
  const Sample sample(SpringLawKind::choi_ko);
  for (const Spring& spring : sample.model->springs()) {
    SpringParameters unknown = spring.parameters;
    unknown.beam = {};
    EXPECT_EQ(spring.parameters.beam, beam_range(unknown));
  }
}

TEST(SpringModel, LargestStrainIsTheLargestOfAll) {
  std::vector<Spring> springs;
  std::vector<Vec3> x{Vec3::Zero()};
  for (Index s = 1; s <= 5000; ++s) {
    x.push_back(x.back() + (s == 4321 ? 1.25 : 1.01) * Vec3::UnitY());
    springs.push_back({s - 1, s, {.rest_length = 1.0, .stiffness = 1.0}});
  }
  const SpringModel model(ForceClass::stretch, SpringLawKind::linear, springs);
  EXPECT_NEAR(largest_strain(model, x), 0.25, 1e-12);
  const std::vector<double> strains = spring_strains(model, x);
  EXPECT_NEAR(strains[4320], 0.25, 1e-12);
  EXPECT_NEAR(strains[0], 0.01, 1e-12);
  for (Vec3& place : x) place *= 0.5;
  EXPECT_NEAR(largest_strain(model, x), 0.5 * 1.25 - 1.0, 1e-12)
      << "negative when all are compressed";
}

}  // namespace
}  // namespace taut
