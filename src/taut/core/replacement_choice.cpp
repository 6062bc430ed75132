#include "taut/core/replacement_choice.h"

#include <algorithm>

#include "taut/base/parallel.h"

namespace taut {

namespace {

constexpr Index most_samples = 512;
constexpr Index samples_ahead = 16;  // for which A is asked: they lie far apart
constexpr Index chunk = 64, chunks_per_task = 4;

struct Energies {
  double across = 0.0, bent = 0.0;
  void operator+=(const Energies& other) { across += other.across, bent += other.bent; }
};

double energy(const double* block, Index width, const Vec3& u) {
  const Eigen::Map<const Mat3, 0, Eigen::OuterStride<>> transposed(block,
                                                                   Eigen::OuterStride<>(width));
  return -u.dot(transposed * u);
}

}  // namespace

bool replacing_pays(const BlockCsr& a, std::span<const Parallelogram> parallelograms,
                    std::span<const double> x) {
  const BlockPattern& pattern = *a.pattern;
  const Index count = static_cast<Index>(parallelograms.size()),
              samples = std::min(count, most_samples);
  const auto sample = [&](Index s) -> const Parallelogram& {
    return parallelograms[static_cast<std::size_t>(Offset{s} * count / samples)];
  };
  const auto prefetch = [&](const Parallelogram& p) {
    const double* block = a.block(p.a, p.block);
    for (Index r = 0; r < 3; ++r) __builtin_prefetch(block + Offset{r} * pattern.width(p.a));
    for (const Index node : {p.a, p.b, p.c, p.d}) __builtin_prefetch(x.data() + Offset{3} * node);
  };
  const auto at = [&](Index node) { return Eigen::Map<const Vec3>(x.data() + Offset{3} * node); };
  const Energies sum = ordered_sum<Energies>(
      samples,
      [&](Index begin, Index end) {
        Energies part;
        for (Index s = begin; s < end; ++s) {
          if (s + samples_ahead < samples) prefetch(sample(s + samples_ahead));
          const Parallelogram& p = sample(s);
          const double* block = a.block(p.a, p.block);
          const Index width = pattern.width(p.a);
          const Vec3 across = at(p.a) - at(p.c), bent = (at(p.a) + at(p.c)) - (at(p.b) + at(p.d));
          part += {energy(block, width, across), energy(block, width, bent)};
        }
        return part;
      },
      chunk, chunks_per_task);
  return sum.bent < sum.across;
}

}  // namespace taut
