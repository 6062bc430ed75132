#pragma once
// What the page must know of a scene before it draws a frame:
//
//   title, folder, nodes, triangles, springs (0: not recorded), uv (bool)
//   frame_s          s between frames
//   frames_expected  frames there will be when the run ends, the one of the start included; null
//                    when scene.toml cannot be read
//   cloths           [{name, first_node, nodes, first_triangle, triangles}]
//   solids           [{name, shape, radius, height, size, thickness, poses}], a pose a frame or one
//                    for all: [x, y, z, qx, qy, qz, qw], m; the shape of a mesh is "unknown": the
//                    page says that it does not draw it
//   note             what is missing and why; empty when all is there
//
// Throws InputError when there is no triangles.npy.

#include <nlohmann/json.hpp>

#include "view/result_files.h"

namespace taut::app {

nlohmann::ordered_json scene_json(const ResultFiles& files);

}  // namespace taut::app
