#pragma once
// Material of a mass-spring cloth (Provot 1995; Choi & Ko 2002). docs/mathematics.md, 2; kernels
// in element/spring_law.h.
//
//   k_stretch, k_shear  N/m a spring
//   k_bend              bend_model linear: N/m a spring; choi_ko: N·m², a flexural rigidity
//   k_damp_*            N·s/m a spring, along the spring
//   bend_cap            c_b of Choi & Ko, N/m: slope of the line that caps the buckled force near
//                       the rest length; 0 means k_stretch

namespace taut {

// What a compressed stretch or shear spring does: `none`: nothing, the cloth buckles (Choi & Ko's
// type 1); `linear`: pushes back.
enum class Compression { none, linear };
// `linear`: a linear spring both ways, its negative transverse term dropped; `choi_ko`: the
// post-buckling force of Choi & Ko's type 2.
enum class BendModel { linear, choi_ko };

struct SpringMaterial {
  double k_stretch = 600.0;
  double k_shear = 0.3;
  double k_bend = 0.05;
  double k_damp_stretch = 0.0;
  double k_damp_shear = 0.0;
  double k_damp_bend = 0.0;
  double bend_cap = 0.0;
  Compression compression = Compression::none;
  BendModel bend_model = BendModel::linear;
  bool operator==(const SpringMaterial&) const = default;
};

}  // namespace taut
