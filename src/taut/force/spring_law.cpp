#include "taut/force/spring_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace taut {

namespace {

// cos u - sinc u, by its series where the difference would cancel: -u²/3 + u⁴/30 - u⁶/840 + u⁸/45360.
double cos_minus_sinc(double u) {
  if (u > 0.3) return std::cos(u) - std::sin(u) / u;
  const double u2 = u * u;
  return u2 * (-1.0 / 3.0 + u2 * (1.0 / 30.0 + u2 * (-1.0 / 840.0 + u2 * (1.0 / 45360.0 - u2 / 3991680.0))));
}

struct Buckled {
  double u, tension, slope;
};

Buckled buckled_beam(const SpringParameters& p, double length) {
  const double l0 = p.rest_length;
  const double u = inverse_sinc(std::clamp(length / l0, 0.0, 1.0));
  const double scale = 4.0 * p.stiffness / (l0 * l0);
  if (u < 1e-4) {
    // g(u) = u²/(cos u - sinc u) = -3 - 3u²/10 + ...,  du/dL = u / (L0 (cos u - sinc u)) = -3/(L0 u):  g' du/dL = (9/5)/L0
    return {u, scale * (-3.0 - 0.3 * u * u), scale * 1.8 / l0};
  }
  const double w = cos_minus_sinc(u);
  const double g = u * u / w;
  const double dg_du = (3.0 * u * w + u * u * std::sin(u)) / (w * w);
  return {u, scale * g, scale * dg_du * u / (l0 * w)};
}

double beam_energy(const SpringParameters& p, double u) { return 2.0 * p.stiffness * u * u / p.rest_length; }

}  // namespace

double crossing_length(const SpringParameters& p) {
  double low = 0.0, high = p.rest_length;
  const auto beam_is_weaker = [&](double length) { return buckled_beam(p, length).tension >= p.cap * (length - p.rest_length); };
  if (!beam_is_weaker(low)) return 0.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (beam_is_weaker(middle) ? low : high) = middle;
  }
  return low;
}

double inverse_sinc(double s) {
  if (s >= 1.0) return 0.0;
  if (s <= 0.0) return std::numbers::pi;
  // Start: near 0, s = 1 - u²/6 + u⁴/120; near π, s = (π - u)/u. Newton on sin(u) - s u converges from either in a few steps.
  double u = s > 0.3 ? std::sqrt(10.0 - std::sqrt(std::max(0.0, 100.0 - 120.0 * (1.0 - s)))) : std::numbers::pi / (1.0 + s);
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

double spring_energy(SpringLawKind law, const SpringParameters& p, double length) {
  if (length <= 0.0) return 0.0;
  const double stretch = length - p.rest_length;
  if (law != SpringLawKind::choi_ko) return law == SpringLawKind::buckling && stretch < 0.0 ? 0.0 : 0.5 * p.stiffness * stretch * stretch;
  const double line = 0.5 * p.cap * stretch * stretch;
  if (stretch >= 0.0) return line;
  const double crossing = p.crossing >= 0.0 ? p.crossing : crossing_length(p);
  if (length >= crossing) return line;
  const double at_crossing = 0.5 * p.cap * (crossing - p.rest_length) * (crossing - p.rest_length);
  return at_crossing + beam_energy(p, buckled_beam(p, length).u) - beam_energy(p, buckled_beam(p, crossing).u);
}

SpringResponse spring_response(SpringLawKind law, const SpringParameters& p, const Vec3& d, const Vec3& relative_velocity) {
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
  response.dropped_damping = p.damping / length * (speed * across + e * (across * relative_velocity).transpose());
  return response;
}

}  // namespace taut
