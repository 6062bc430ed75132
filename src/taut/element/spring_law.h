#pragma once
// The law of one spring between nodes i and j (docs/mathematics.md, 2; Provot 1995; Choi & Ko
// 2002). With d = x_j - x_i, L = |d|, e = d/L, rest length L0 (m):
//
//   force    f_i = T(L) e + k_d e eᵀ (v_j - v_i),  f_j = -f_i                            N
//   exact    -df_i/dx_i = T'(L) e eᵀ + T(L)/L (I - e eᵀ), of the elastic part            N/m
//   used     K_s = T' e eᵀ + max(T/L, 0) (I - e eᵀ), without the transverse term of a
//            compressed spring; D_s = k_d e eᵀ, whose change with x is dropped           N/m, N s/m
//
//   linear     T = k (L - L0)                    both ways
//   buckling   the same for L >= L0, else 0      stretch and shear: Choi & Ko's type 1
//   choi_ko    c_b (L - L0) for L >= L0; below, the weaker push of that line and of the beam of
//              flexural rigidity k_b (N·m²) buckled into an arc: sinc(u) = L/L0, κ = 2u/L0,
//              T = k_b κ² / (cos u - sinc u) < 0, energy ½ k_b κ² L0      Choi & Ko's type 2
//
// A spring that is slack does not damp; a collapsed one (L = 0) gives nothing.

#include "taut/base/types.h"

namespace taut {

enum class SpringLawKind { linear, buckling, choi_ko };

// choi_ko: the lengths between which the beam pushes less than the line c_b (L - L0) would: in
// general from 0 to somewhat below L0. A line with c_b L0³/k_b < 31.47 is weaker at every length
// (upper = 0), one between that and 4π² also near L = 0 (lower > 0).
struct BeamRange {
  double lower = 0.0, upper = -1.0;  // m; upper negative: not known
  bool known() const { return upper >= 0.0; }
  bool operator==(const BeamRange&) const = default;
};

struct SpringParameters {
  double rest_length = 1.0;  // m
  double stiffness = 0.0;    // N/m; N·m² for choi_ko
  double damping = 0.0;      // N s/m
  double cap = 0.0;          // c_b, N/m; choi_ko only
  BeamRange beam = {};       // choi_ko only; found when needed (slow) if not known
  bool operator==(const SpringParameters&) const = default;
};
BeamRange beam_range(const SpringParameters& p);

// T and T' at length L.
struct SpringTension {
  double tension = 0.0;  // N
  double slope = 0.0;    // N/m
  bool slack = true;
};
SpringTension spring_tension(SpringLawKind law, const SpringParameters& p, double length);
// The largest eigenvalue of K_s at any length, N/m: k; for choi_ko the steeper of the line and the
// beam folded flat (L = 0), 12 π² k_b/L0³.
double largest_stiffness(SpringLawKind law, const SpringParameters& p);
// ∫ T dL from the rest length, J.
double spring_energy(SpringLawKind law, const SpringParameters& p, double length);

// Force and the two Jacobians of node i; those of j follow by sign.
struct SpringResponse {
  double energy = 0.0;                     // J
  Vec3 force = Vec3::Zero();               // on i, N
  Mat3 stiffness = Mat3::Zero();           // K_s as used
  Mat3 damping = Mat3::Zero();             // D_s
  Mat3 dropped_transverse = Mat3::Zero();  // exact elastic minus used
  Mat3 dropped_damping = Mat3::Zero();     // -d(damping force)/dx, dropped
  Mat3 exact_stiffness() const { return stiffness + dropped_transverse + dropped_damping; }
};
// The readable form, for tests, dumps and small tools; element/spring_model.cpp evaluates
// the same formulas in bulk.
SpringResponse spring_response(SpringLawKind law, const SpringParameters& p, const Vec3& d,
                               const Vec3& relative_velocity);

// u in [0, π] with sin(u)/u = s, s in [0, 1]; error below 1e-14.
double inverse_sinc(double s);

}  // namespace taut
