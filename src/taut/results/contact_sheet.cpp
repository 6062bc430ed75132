#include "taut/base/error.h"
#include "taut/results/frame_picture.h"
#include "taut/results/run.h"
#include "taut/sim/cloth_model.h"

namespace taut {

void draw_contact_sheet(const SceneSimulation& simulation, const ResultsFolder& results) {
  constexpr int most_tiles = 6;
  const int count = results.frame_count();
  if (count == 0)
    throw InputError({results.folder().string()}, "holds no frames; run a scene into it first");
  PictureOptions options;
  options.width = 480;
  options.height = 400;
  options.samples = 5;  // every run ends with it: less than a second on two cores
  draw_contact_sheet(results.contact_sheet_file(), simulation.scene(), simulation.cloth(), results,
                     spread_frames(count - 1, most_tiles), options);
}

}  // namespace taut
