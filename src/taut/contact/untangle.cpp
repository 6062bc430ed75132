#include "taut/contact/untangle.h"

#include <fmt/format.h>

#include <algorithm>

#include "taut/contact/untangle_separate.h"
#include "taut/contact/untangle_settle.h"

namespace taut {

namespace {

constexpr double length_slack = 0.01;
constexpr double deep_share = 0.05;  // of the thickness: what contact with solids lets be, at least

double mean_edge(const UntangleInput& input) {
  double sum = 0.0;
  Index count = 0;
  for (std::size_t e = 0; e < input.surface.edges.size(); ++e) {
    if (input.surface.is_solid[input.surface.edges[e][0]]) continue;
    sum += input.rest[e];
    ++count;
  }
  return count > 0 ? sum / count : 1.0;
}

void measure(std::span<const Vec3> before, std::span<const Vec3> after, UntangleReport& report) {
  double sum = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double way = (after[i] - before[i]).norm();
    if (way == 0.0) continue;
    ++report.moved;
    sum += way;
    report.largest = std::max(report.largest, way);
  }
  if (report.moved > 0) report.mean = sum / report.moved;
}

std::string why_not(const UntangleReport& report, double least_excess, double most_excess) {
  if (!report.left.empty())
    return fmt::format(
        "of {} intersections {} are left after {} passes, whichever way they were drawn apart",
        report.intersections_before, report.left.size(), report.passes);
  if (least_excess <= most_excess)
    return fmt::format("{} intersections were drawn apart, but layers were left without a gap",
                       report.intersections_before);
  return fmt::format(
      "{} intersections, with {} nodes inside solids, can only be drawn apart by stretching or "
      "squeezing edges by {:.1f} %",
      report.intersections_before, report.inside_solids_before, 100 * least_excess);
}

}  // namespace

UntangleReport untangle(const UntangleInput& input, std::span<Vec3> x,
                        const UntangleOptions& options) {
  UntangleReport report;
  const std::vector<Vec3> start(x.begin(), x.end());
  BroadPhase broad_phase(input.surface, start);
  report.intersections_before = static_cast<Index>(find_intersections(broad_phase, start).size());
  report.inside_solids_before = count_inside_solids(input, start, input.contact.touch_tolerance);
  report.stretch_before = report.stretch_after = worst_stretch(input.surface, input.rest, start);
  if (report.intersections_before == 0 && report.inside_solids_before == 0) return report;

  const EdgeFaces faces(input.surface);
  const std::vector<LengthRange> ranges =
      length_ranges(input.surface, start, input.rest, length_slack);
  const double edge = mean_edge(input);
  const SeparationWay ways[] = {
      {0.05 * edge, true}, {0.05 * edge, false}, {0.2 * edge, true}, {0.02 * edge, true}};
  double least_excess = 0.0;
  bool found_one = false;
  for (const SeparationWay& way : ways) {
    std::vector<Vec3> trial = start;
    const SeparationResult separated =
        separate(input, faces, ranges, broad_phase, way, options, trial);
    report.passes += separated.passes;
    if (report.attempts++ == 0 || separated.left.size() < report.left.size())
      report.left = separated.left;
    if (!separated.left.empty()) continue;
    const SettledQuality quality = settle(input, ranges, options, trial, report.rounds);
    // cannot be; what is handed on is checked all the same
    if (!find_intersections(broad_phase, trial).empty()) continue;
    least_excess = found_one ? std::min(least_excess, quality.excess) : quality.excess;
    found_one = true;
    if (quality.excess > options.most_excess || quality.gap <= 0.0) continue;
    report.gap = quality.gap;
    const double deep =
        std::max(input.contact.touch_tolerance, deep_share * input.contact.thickness);
    report.inside_solids_after = count_inside_solids(input, trial, deep);
    report.stretch_after = worst_stretch(input.surface, input.rest, trial);
    measure(start, trial, report);
    std::ranges::copy(trial, x.begin());
    return report;
  }
  report.status = {Outcome::max_iterations, why_not(report, least_excess, options.most_excess)};
  return report;
}

}  // namespace taut
