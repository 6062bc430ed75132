#include "taut/element/spring_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace taut {

namespace {

// Below this u the differences below cancel and their series, cut after the last term given, are
// exact to rounding.
constexpr double series_limit = 0.3;

// w / u², w = cos u - sinc u. The series of w: sum over k of (-1)^k 2k/(2k+1)! u^2k.
double scaled_cos_minus_sinc(double u) {
  const double u2 = u * u;
  if (u > series_limit) return (std::cos(u) - std::sin(u) / u) / u2;
  return -1.0 / 3.0 +
         u2 * (1.0 / 30.0 + u2 * (-1.0 / 840.0 + u2 * (1.0 / 45360.0 - u2 / 3991680.0)));
}

double cos_minus_sinc(double u) { return u * u * scaled_cos_minus_sinc(u); }

// (3 u w + u² sin u) / u⁵: how u²/w changes with u, times w²/u⁵. Its series: sum over k of
// (-1)^(k-1) 2k (2k-2)/(2k+1)! u^(2k-4), k from 2.
double scaled_slope_numerator(double u) {
  const double u2 = u * u;
  if (u > series_limit) return (3.0 * cos_minus_sinc(u) + u * std::sin(u)) / (u2 * u2);
  return -1.0 / 15.0 +
         u2 * (1.0 / 210.0 + u2 * (-1.0 / 7560.0 + u2 * (1.0 / 498960.0 - u2 / 51891840.0)));
}

struct Buckled {
  double u, tension, slope;
};

// f_b = 4 k_b/L0² u²/w and du/dL = u/(L0 w), both without a division by zero at u = 0.
Buckled buckled_beam(const SpringParameters& p, double length) {
  const double l0 = p.rest_length;
  const double u = inverse_sinc(std::clamp(length / l0, 0.0, 1.0));
  const double scale = 4.0 * p.stiffness / (l0 * l0);
  const double w = scaled_cos_minus_sinc(u);
  return {u, scale / w, scale * scaled_slope_numerator(u) / (l0 * w * w * w)};
}

double beam_energy(const SpringParameters& p, double u) {
  return 2.0 * p.stiffness * u * u / p.rest_length;
}

}  // namespace

BeamRange beam_range(const SpringParameters& p) {
  // L/L0 where the beam pushes least in proportion to L0 - L. A line that is weaker
  // there is weaker everywhere.
  constexpr double weakest = 0.27948525989761236;
  const auto beam_is_weaker = [&](double length) {
    return buckled_beam(p, length).tension >= p.cap * (length - p.rest_length);
  };
  const auto boundary = [&](double inside, double outside) {
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (inside + outside);
      (beam_is_weaker(middle) ? inside : outside) = middle;
    }
    return inside;
  };
  const double seen = weakest * p.rest_length;
  if (!beam_is_weaker(seen)) return {0.0, 0.0};
  return {beam_is_weaker(0.0) ? 0.0 : boundary(seen, 0.0), boundary(seen, p.rest_length)};
}

double inverse_sinc(double s) {
  if (s >= 1.0) return 0.0;
  if (s <= 0.0) return std::numbers::pi;
  // Start: near 0, s = 1 - u²/6 + u⁴/120; near π, s = (π - u)/u. Newton on sin(u) - s u converges
  // from either in a few steps.
  double u = s > 0.3 ? std::sqrt(10.0 - std::sqrt(std::max(0.0, 100.0 - 120.0 * (1.0 - s))))
                     : std::numbers::pi / (1.0 + s);
  // Near u = 0 the equation is flat: solve 1 - sinc(u) = 1 - s by its series there.
  if (1.0 - s < 1e-4) {
    const double t = 6.0 * (1.0 - s);
    return std::sqrt(t * (1.0 + t * (1.0 / 20.0 + t * (2.0 / 525.0))));
  }
  for (int i = 0; i < 8; ++i) {
    const double step = (std::sin(u) / u - s) * u / cos_minus_sinc(u);
    u -= step;
    if (std::abs(step) < 1e-15 * u) break;
  }
  return std::clamp(u, 0.0, std::numbers::pi);
}

SpringTension spring_tension(SpringLawKind law, const SpringParameters& p, double length) {
  if (length <= 0.0) return {};
  const double stretch = length - p.rest_length;
  if (law != SpringLawKind::choi_ko) {
    if (law == SpringLawKind::buckling && stretch < 0.0) return {};
    return {p.stiffness * stretch, p.stiffness, false};
  }
  const SpringTension line{p.cap * stretch, p.cap, false};
  if (stretch >= 0.0) return line;
  const Buckled beam = buckled_beam(p, length);
  return beam.tension < line.tension ? line : SpringTension{beam.tension, beam.slope, false};
}

double largest_stiffness(SpringLawKind law, const SpringParameters& p) {
  // T/L = k (1 - L0/L) < k in extension, and is dropped in compression.
  if (law != SpringLawKind::choi_ko) return p.stiffness;
  const double folded = 12.0 * std::numbers::pi * std::numbers::pi * p.stiffness /
                        (p.rest_length * p.rest_length * p.rest_length);
  return std::max(p.cap, folded);
}

double spring_energy(SpringLawKind law, const SpringParameters& p, double length) {
  if (length <= 0.0) return 0.0;
  const double stretch = length - p.rest_length;
  if (law != SpringLawKind::choi_ko)
    return law == SpringLawKind::buckling && stretch < 0.0 ? 0.0
                                                           : 0.5 * p.stiffness * stretch * stretch;
  const double line = 0.5 * p.cap * stretch * stretch;
  if (stretch >= 0.0) return line;
  const BeamRange beam = p.beam.known() ? p.beam : beam_range(p);
  if (length >= beam.upper) return line;
  // The line's work outside the range, the beam's inside.
  const auto line_energy = [&](double at) {
    return 0.5 * p.cap * (at - p.rest_length) * (at - p.rest_length);
  };
  const auto energy_of_beam = [&](double at) { return beam_energy(p, buckled_beam(p, at).u); };
  const double in_range = std::max(length, beam.lower);
  return line_energy(beam.upper) + energy_of_beam(in_range) - energy_of_beam(beam.upper) +
         (line - line_energy(in_range));
}

SpringResponse spring_response(SpringLawKind law, const SpringParameters& p, const Vec3& d,
                               const Vec3& relative_velocity) {
  SpringResponse response;
  const double length = d.norm();
  if (length <= 0.0) return response;
  const Vec3 e = d / length;
  const Mat3 along = e * e.transpose();
  const Mat3 across = Mat3::Identity() - along;
  const SpringTension t = spring_tension(law, p, length);
  response.energy = spring_energy(law, p, length);
  if (t.slack) return response;
  const double transverse = t.tension / length;
  const double speed = e.dot(relative_velocity);
  response.force = (t.tension + p.damping * speed) * e;
  response.stiffness = t.slope * along + std::max(transverse, 0.0) * across;
  response.dropped_transverse = std::min(transverse, 0.0) * across;
  response.damping = p.damping * along;
  response.dropped_damping =
      p.damping / length * (speed * across + e * (across * relative_velocity).transpose());
  return response;
}

}  // namespace taut
