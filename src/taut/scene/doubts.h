#pragma once
// What doubtful() (scene_file.h) is made of: each function adds a sentence for what it finds.

#include <fmt/format.h>

#include <string>
#include <vector>

#include "taut/scene/cloth_estimate.h"
#include "taut/scene/scene.h"

namespace taut {

struct Doubts {
  const Scene& scene;
  std::vector<std::string> found;

  template <class... Args>
  void add(fmt::format_string<Args...> text, Args&&... args) {
    found.push_back(fmt::format(text, std::forward<Args>(args)...));
  }
};

// `shape`: start_shape (cloth_shape.h). Pins that pull faster than cloth can follow, hold one node
// in two ways, move nothing, or hold a node inside a solid.
void doubt_pins(Doubts& d, const Cloth& cloth, const TriangleMesh& shape, const ClothEstimate& e);
// One entry a node.
std::vector<bool> pinned_at_start(const Cloth& cloth, std::size_t nodes);

}  // namespace taut
