#pragma once
// Springs and states for tests of whole models: some stretched, some slack, some collapsed.

#include <random>

#include "taut/element/spring_model.h"

namespace taut::test {

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  Index index(Index count) {
    return std::uniform_int_distribution<Index>(0, count - 1)(generator_);
  }
  Vec3 vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  std::vector<Vec3> vectors(Index count, double size) {
    std::vector<Vec3> all;
    for (Index i = 0; i < count; ++i) all.push_back(vector(size));
    return all;
  }

 private:
  std::mt19937_64 generator_;
};

// `count` springs among x; every 13th is stretched to infinity (rest length tiny), every 7th joins
// nodes 0 and 1 (collapsed if these coincide).
inline std::vector<Spring> random_springs(Random& random, std::span<const Vec3> x, Index count) {
  const Index nodes = static_cast<Index>(x.size());
  std::vector<Spring> springs;
  while (static_cast<Index>(springs.size()) < count) {
    const Index s = static_cast<Index>(springs.size());
    Spring spring{random.index(nodes), random.index(nodes), {}};
    if (s % 7 == 3) spring.i = 0, spring.j = 1;
    if (spring.i == spring.j) continue;
    const double length = (x[spring.j] - x[spring.i]).norm();
    spring.parameters.rest_length =
        s % 13 == 5 ? 1e-3 : std::max(0.01, length * random.uniform(0.5, 1.8));
    spring.parameters.stiffness = random.uniform(0.1, 50.0);
    spring.parameters.damping = s % 3 == 0 ? 0.0 : random.uniform(0.01, 2.0);
    spring.parameters.cap = random.uniform(1.0, 2000.0) * spring.parameters.stiffness /
                            std::pow(spring.parameters.rest_length, 3) / 30.0;
    springs.push_back(spring);
  }
  return springs;
}

}  // namespace taut::test
