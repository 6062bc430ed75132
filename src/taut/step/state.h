#pragma once
// The state of the cloth at one time, and what multistep methods remember.
//
//   x, v            m, m/s, one per node
//   x_prev, v_prev  at the previous step; meaningful when has_previous (BDF2 begins with one Euler
//                   step otherwise)
//   last            the last solved unknown (dv or dx), the next solve's initial guess

#include "taut/base/types.h"

namespace taut {

struct State {
  double time = 0.0;
  std::vector<Vec3> x, v;
  std::vector<Vec3> x_prev, v_prev;
  std::vector<Vec3> last;
  bool has_previous = false;
};

}  // namespace taut
