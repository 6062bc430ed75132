#pragma once
// The frames of a results folder, finished or still growing, with the scene they belong to: what
// export and pictures read.
//
//   time of a frame    frame * h * steps_per_frame, s
//   velocity           (x_k - x_{k-1}) / (time between frames), m/s: the mean since the frame
//                      before, which with one step a frame is the integrator's velocity; frame 0:
//                      the scene's initial velocity
//   stretch            of a node: the largest L/L0 - 1 of its stretch springs; 0 where it has none
//   contact            the bits that the run has recorded (sim/node_contact.h) as a number. Of a
//                      folder without them: 1 for nodes whose distance from an analytic solid
//                      (outside its thickness) is below 0.1 mm + 2e-4 of its size, else 0

#include "taut/results/results.h"
#include "taut/sim/cloth_model.h"

namespace taut {

struct NodeFields {
  std::vector<Vec3> velocity;
  std::vector<double> stretch, contact;
};

class ResultFrames {
 public:
  // Reads DIR/scene.toml. Throws InputError when that is missing or bad.
  explicit ResultFrames(const std::filesystem::path& folder);

  const ResultsFolder& results() const { return results_; }
  const Scene& scene() const { return scene_; }
  const ClothModel& cloth() const { return cloth_; }
  double interval() const { return scene_.time.step * scene_.time.steps_per_frame; }
  double time_of(int frame) const { return frame * interval(); }

  // Of the frames that are there now; throws InputError when there is none.
  int last_frame() const;
  // False while the run goes on, or was interrupted or failed.
  bool run_has_finished() const;
  // Throws InputError when the frame is missing, damaged or has another number of nodes than the
  // scene.
  std::vector<Vec3> positions(int frame) const;
  // `x`: the frame's positions.
  NodeFields fields(int frame, std::span<const Vec3> x) const;

 private:
  std::vector<double> contact(int frame, std::span<const Vec3> x) const;

  ResultsFolder results_;
  Scene scene_;
  ClothModel cloth_;
};

}  // namespace taut
