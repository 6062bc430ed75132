#pragma once
// Scenes that start intersecting.

#include <string>

namespace taut::test {

// A sheet whose border has slipped under its neighbour; lines of the lower one's table beside its
// shape.
inline std::string slipped_scene(const std::string& of_lower = "") {
  return R"(title = "Slipped"
[time]
step = 4e-3
frames = 2
[[cloth]]
name = "low"
grid = { nodes = [15, 15], origin = [-0.1, -0.1, 0], u = [0.2, 0, 0], v = [0, 0.2, 0] }
density = 0.15
)" + of_lower +
         R"(
[[cloth]]
name = "high"
grid = { nodes = [13, 13], origin = [-0.09, -0.093, 0.008], u = [0.17, 0, -0.02], v = [0, 0.17, 0] }
density = 0.15
jitter = 1e-4
)";
}

// A strip right through the middle of a sheet: no way leads out.
inline std::string pierced_scene() {
  return R"(
[[cloth]]
name = "sheet"
grid = { nodes = [11, 11], origin = [-0.1, -0.1, 0], u = [0.2, 0, 0], v = [0, 0.2, 0] }
density = 0.15
[[cloth]]
name = "strip"
grid = { nodes = [31, 4], origin = [0.001, -0.015, -0.3], u = [0, 0.001, 0.6], v = [0, 0.03, 0] }
density = 0.15
)";
}

}  // namespace taut::test
