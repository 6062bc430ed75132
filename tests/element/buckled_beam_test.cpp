// Choi & Ko's post-buckling force against the geometry of the arc that it comes from: chord L = L0
// sin(u)/u, curvature κ = 2u/L0, energy ½ k_b κ² L0.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "taut/element/spring_law.h"

namespace taut {
namespace {

// By bisection in long double, on 1 - sinc(u) as a series where sinc itself would lose digits.
double reference_inverse_sinc(double s) {
  const auto one_minus_sinc = [](long double u) {
    if (u > 1.0L) return 1.0L - std::sin(u) / u;
    long double term = u * u / 6.0L, sum = 0.0L;
    for (int k = 2; k < 14; ++k) sum += term, term *= -u * u / ((2.0L * k) * (2.0L * k + 1.0L));
    return sum;
  };
  const long double wanted = 1.0L - static_cast<long double>(s);
  long double low = 0.0L, high = std::numbers::pi_v<long double>;
  for (int i = 0; i < 120; ++i)
    (one_minus_sinc(0.5L * (low + high)) < wanted ? low : high) = 0.5L * (low + high);
  return static_cast<double>(0.5L * (low + high));
}

TEST(InverseSinc, IsAccurateOverTheWholeRange) {
  for (int k = 0; k <= 4000; ++k) {
    const double s = k / 4000.0;
    EXPECT_NEAR(inverse_sinc(s), reference_inverse_sinc(s), 1e-14) << "s = " << s;
  }
  for (double gap = 0.1; gap > 1e-16; gap *= 0.9) {
    EXPECT_NEAR(inverse_sinc(1.0 - gap), reference_inverse_sinc(1.0 - gap), 1e-14)
        << "1 - s = " << gap;
    EXPECT_NEAR(inverse_sinc(gap), reference_inverse_sinc(gap), 1e-14) << "s = " << gap;
  }
  EXPECT_EQ(inverse_sinc(1.0), 0.0);
  EXPECT_EQ(inverse_sinc(0.0), std::numbers::pi);
  EXPECT_EQ(inverse_sinc(1.0 + 1e-12), 0.0);
}

// k_b = 2e-6 N m², L0 = 3 cm; the line is so steep that only the beam is seen.
constexpr SpringParameters beam{
    .rest_length = 0.03, .stiffness = 2e-6, .damping = 0.0, .cap = 1e14};

TEST(BuckledBeam, EnergyIsThatOfAnArc) {
  for (const double u : {0.05, 0.2, 0.29, 0.31, 0.8, 1.5, 2.2, 3.0}) {
    const double curvature = 2.0 * u / beam.rest_length;
    const double energy = 0.5 * beam.stiffness * curvature * curvature * beam.rest_length;
    EXPECT_NEAR(spring_energy(SpringLawKind::choi_ko, beam, beam.rest_length * std::sin(u) / u),
                energy, 1e-9 * energy)
        << "u = " << u;
  }
}

TEST(BuckledBeam, ForceIsTheArcsEnergyByChord) {
  // dE/dL = (dE/du) / (dL/du), with E = 2 k_b u²/L0 and L = L0 sin(u)/u.
  for (const double u : {0.02, 0.2, 0.299999, 0.300001, 1.0, 2.0, 3.1}) {
    const double expected = 4.0 * beam.stiffness * u / beam.rest_length /
                            (beam.rest_length * (std::cos(u) / u - std::sin(u) / (u * u)));
    const double found =
        spring_tension(SpringLawKind::choi_ko, beam, beam.rest_length * std::sin(u) / u).tension;
    EXPECT_NEAR(found, expected, 1e-10 * std::abs(expected)) << "u = " << u;
  }
}

// Just buckled, cos u - sinc u = -u²/3 + u⁴/30 gives f_b = -k_b/L0² (12 + 6u²/5), and 1 - L/L0 =
// u²/6 turns that into df_b/dL = 7.2 k_b/L0³.
TEST(BuckledBeam, AtTheOnsetForceAndSlopeAreTheLimits) {
  const double unit = beam.stiffness / (beam.rest_length * beam.rest_length);
  for (double gap = 1e-3; gap > 1e-11; gap *= 0.5) {
    const SpringTension t =
        spring_tension(SpringLawKind::choi_ko, beam, beam.rest_length * (1.0 - gap));
    // To first order f = -12 - 7.2 gap; the slope changes by about 16 gap.
    EXPECT_NEAR(t.tension / unit, -12.0 - 7.2 * gap, 10.0 * gap * gap + 1e-12)
        << "1 - L/L0 = " << gap;
    EXPECT_NEAR(t.slope * beam.rest_length / unit, 7.2, 20.0 * gap + 1e-9) << "1 - L/L0 = " << gap;
  }
}

TEST(BuckledBeam, CrossingIsWhereTheLineAndTheBeamPushAlike) {
  SpringParameters p{.rest_length = 0.02, .stiffness = 1e-5, .damping = 0.0, .cap = 600.0};
  const auto beam_force = [&](double length) {
    const double u = reference_inverse_sinc(length / p.rest_length);
    return 4.0 * p.stiffness * u * u / (p.rest_length * p.rest_length) /
           (std::cos(u) - std::sin(u) / u);
  };
  const double crossing = beam_range(p).upper;
  EXPECT_EQ(beam_range(p).lower, 0.0);
  EXPECT_NEAR(beam_force(crossing), p.cap * (crossing - p.rest_length),
              1e-9 * std::abs(beam_force(crossing)));
  EXPECT_GT(crossing, 0.97 * p.rest_length);
  EXPECT_EQ(spring_tension(SpringLawKind::choi_ko, p, crossing * 1.001).slope, p.cap);
  EXPECT_LT(spring_tension(SpringLawKind::choi_ko, p, crossing * 0.999).slope, p.cap);

  p.cap = 31.46 * p.stiffness / std::pow(p.rest_length, 3);
  EXPECT_EQ(beam_range(p).upper, 0.0) << "a line that is weaker than the beam at all lengths";
  for (const double ratio : {31.48, 35.0, 39.4}) {
    p.cap = ratio * p.stiffness / std::pow(p.rest_length, 3);
    const BeamRange range = beam_range(p);
    EXPECT_LT(0.0, range.lower);
    EXPECT_LT(range.lower, range.upper);
    for (const double length : {range.lower, range.upper})
      EXPECT_NEAR(beam_force(length), p.cap * (length - p.rest_length),
                  1e-9 * std::abs(beam_force(length)))
          << ratio;
  }
  p.cap = 39.5 * p.stiffness / std::pow(p.rest_length, 3);
  EXPECT_EQ(beam_range(p).lower, 0.0);
}

// Between c_b L0³/k_b = 31.4 and 4π² the line is weaker near L0 and again near 0, the beam weaker
// in between.
TEST(BuckledBeam, EnergyFollowsTheForceWhereTheLineIsWeakerTwice) {
  SpringParameters p{.rest_length = 0.02, .stiffness = 1e-5, .damping = 0.0, .cap = 0.0};
  for (const double ratio : {31.0, 32.0, 35.0, 39.0, 40.0}) {
    p.cap = ratio * p.stiffness / std::pow(p.rest_length, 3);
    // Work by Simpson's rule from L0 down, pieces so small that kinks do not matter.
    double work = 0.0;
    const int pieces = 20000;
    for (int k = 0; k < pieces; ++k) {
      const double a = p.rest_length * (1.0 - double(k) / pieces),
                   b = p.rest_length * (1.0 - (k + 1.0) / pieces);
      const auto push = [&](double length) {
        return -spring_tension(SpringLawKind::choi_ko, p, std::max(length, 1e-12)).tension;
      };
      work += (a - b) / 6.0 * (push(a) + 4.0 * push(0.5 * (a + b)) + push(b));
      if (k % 1999 != 1998) continue;
      EXPECT_NEAR(spring_energy(SpringLawKind::choi_ko, p, b), work, 1e-7 * work)
          << "ratio " << ratio << ", L " << b;
    }
  }
}

}  // namespace
}  // namespace taut
