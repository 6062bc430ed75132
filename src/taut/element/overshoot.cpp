#include "taut/element/overshoot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "taut/base/parallel.h"

namespace taut {

double spring_overshoot(SpringLawKind law, const SpringParameters& p, const Vec3& d0,
                        const Vec3& d1) {
  const double length = d1.norm(), rest = p.rest_length;
  if (length <= rest) return 0.0;
  const double start = d0.norm();
  const bool stiff = start > 0.0 && (law != SpringLawKind::buckling || start >= rest);
  const double foreseen = stiff ? d0.dot(d1) / start : rest;
  return (length - std::max(foreseen, rest)) / rest;
}

double largest_overshoot(const SpringModel& model, std::span<const Vec3> x_start,
                         std::span<const Vec3> x_end) {
  struct Largest {
    double value = 0.0;
    // A NaN is worse than any number.
    Largest& operator+=(const Largest& other) {
      value = std::isfinite(other.value) ? std::max(value, other.value)
                                         : std::numeric_limits<double>::infinity();
      return *this;
    }
  };
  const auto springs = model.springs();
  return ordered_sum<Largest>(
             static_cast<Index>(springs.size()),
             [&](Index begin, Index end) {
               Largest largest;
               for (Index s = begin; s < end; ++s) {
                 const auto& [i, j, parameters] = springs[s];
                 largest += Largest{spring_overshoot(model.law(), parameters,
                                                     x_start[j] - x_start[i], x_end[j] - x_end[i])};
               }
               return largest;
             })
      .value;
}

}  // namespace taut
