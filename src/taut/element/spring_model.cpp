#include "taut/element/spring_model.h"

#include <algorithm>
#include <cmath>

#include "taut/base/parallel.h"

namespace taut {

const char* name_of(ForceClass force_class) {
  switch (force_class) {
    case ForceClass::stretch:
      return "stretch";
    case ForceClass::shear:
      return "shear";
    case ForceClass::bend:
      return "bend";
    case ForceClass::contact:
      return "contact";
  }
  return "unknown";
}

namespace {

constexpr Index springs_per_task = 1024;

// The law as a template argument: the linear ones then have no branch on it in the loop.
template <SpringLawKind law>
void evaluate_range(std::span<const Spring> springs, const ForceRequest& request, double* blocks,
                    Vec3* vectors, Index begin, Index end) {
  const bool wants_matrix = request.wants_matrix();
  const bool k_operand = !request.stiffness_operand.empty(),
             d_operand = !request.damping_operand.empty();
  for (Index s = begin; s < end; ++s) {
    const Spring& spring = springs[s];
    const SpringParameters& p = spring.parameters;
    const Vec3 d = request.x[spring.j] - request.x[spring.i];
    const double length = std::sqrt(d.squaredNorm());
    double* block = blocks + 9 * static_cast<std::ptrdiff_t>(s);
    const SpringTension t = spring_tension(law, p, length);
    if (t.slack) {
      if (wants_matrix) std::fill(block, block + 9, 0.0);
      vectors[s].setZero();
      continue;
    }
    const double inverse_length = 1.0 / length;
    const Vec3 e = d * inverse_length;
    const double transverse = std::max(t.tension * inverse_length, 0.0);
    const double damping = p.damping;
    const double speed = damping != 0.0 ? e.dot(request.v[spring.j] - request.v[spring.i]) : 0.0;

    Vec3 g = (request.force * (t.tension + damping * speed)) * e;
    if (k_operand) {
      // K p of node i: K_s (p_i - p_j)
      const Vec3 w = request.stiffness_operand[spring.i] - request.stiffness_operand[spring.j];
      g += transverse * w + ((t.slope - transverse) * e.dot(w)) * e;
    }
    if (d_operand)
      g +=
          (damping * e.dot(request.damping_operand[spring.i] - request.damping_operand[spring.j])) *
          e;
    vectors[s] = g;

    if (wants_matrix) {
      const double across = request.matrix_stiffness * transverse;
      const double along =
          request.matrix_stiffness * t.slope + request.matrix_damping * damping - across;
      const double ax = along * e.x(), ay = along * e.y(), az = along * e.z();
      block[0] = ax * e.x() + across, block[1] = ax * e.y(), block[2] = ax * e.z();
      block[3] = block[1], block[4] = ay * e.y() + across, block[5] = ay * e.z();
      block[6] = block[2], block[7] = block[5], block[8] = az * e.z() + across;
    }
  }
}

}  // namespace

SpringModel::SpringModel(ForceClass force_class, SpringLawKind law, std::vector<Spring> springs)
    : class_(force_class), law_(law), springs_(std::move(springs)) {
  if (law_ != SpringLawKind::choi_ko) return;
  // Found by bisection, so once for all springs that are alike (on a grid: nearly all).
  SpringParameters last;
  for (Spring& s : springs_) {
    SpringParameters own = s.parameters;
    own.beam = last.beam;
    if (!(own == last)) own.beam = beam_range(s.parameters);
    s.parameters = last = own;
  }
}

void SpringModel::connect(ConnectionSink& sink) const {
  for (Index s = 0; s < block_count(); ++s) {
    const auto [i, j, parameters] = springs_[s];
    sink.matrix(s, i, i, +1, false);
    sink.matrix(s, j, j, +1, false);
    sink.matrix(s, i, j, -1, false);
    sink.matrix(s, j, i, -1, false);
    sink.vector(s, i, +1);
    sink.vector(s, j, -1);
  }
}

void SpringModel::evaluate(const ForceRequest& request, std::span<double> blocks,
                           std::span<Vec3> vectors) const {
  parallel_for(block_count(), springs_per_task, [&](Index begin, Index end) {
    switch (law_) {
      case SpringLawKind::linear:
        return evaluate_range<SpringLawKind::linear>(springs_, request, blocks.data(),
                                                     vectors.data(), begin, end);
      case SpringLawKind::buckling:
        return evaluate_range<SpringLawKind::buckling>(springs_, request, blocks.data(),
                                                       vectors.data(), begin, end);
      case SpringLawKind::choi_ko:
        return evaluate_range<SpringLawKind::choi_ko>(springs_, request, blocks.data(),
                                                      vectors.data(), begin, end);
    }
  });
}

void SpringModel::bound_blocks(double matrix_stiffness, double matrix_damping,
                               std::span<double> bounds) const {
  for (std::size_t s = 0; s < springs_.size(); ++s) {
    const SpringParameters& p = springs_[s].parameters;
    bounds[s] = matrix_stiffness * largest_stiffness(law_, p) + matrix_damping * p.damping;
  }
}

double SpringModel::energy(std::span<const Vec3> x) const {
  return ordered_sum(block_count(), [&](Index begin, Index end) {
    double sum = 0.0;
    for (Index s = begin; s < end; ++s)
      sum +=
          spring_energy(law_, springs_[s].parameters, (x[springs_[s].j] - x[springs_[s].i]).norm());
    return sum;
  });
}

Index SpringModel::collapsed(std::span<const Vec3> x) const {
  return static_cast<Index>(
      std::ranges::count_if(springs_, [&](const Spring& s) { return x[s.i] == x[s.j]; }));
}

double largest_strain(const SpringModel& model, std::span<const Vec3> x) {
  struct Largest {
    double value = -1.0;
    Largest& operator+=(const Largest& other) {
      return value = std::max(value, other.value), *this;
    }
  };
  const auto springs = model.springs();
  return ordered_sum<Largest>(static_cast<Index>(springs.size()),
                              [&](Index begin, Index end) {
                                Largest largest;
                                for (Index s = begin; s < end; ++s)
                                  largest += Largest{(x[springs[s].j] - x[springs[s].i]).norm() /
                                                         springs[s].parameters.rest_length -
                                                     1.0};
                                return largest;
                              })
      .value;
}

std::vector<double> spring_strains(const SpringModel& model, std::span<const Vec3> x) {
  std::vector<double> strains;
  strains.reserve(model.springs().size());
  for (const Spring& s : model.springs())
    strains.push_back((x[s.j] - x[s.i]).norm() / s.parameters.rest_length - 1.0);
  return strains;
}

}  // namespace taut
