#pragma once
// A scene: everything a simulation needs, as plain options, units SI. Read from TOML by
// scene/scene_file.h, which is also where every key's meaning, unit, range and default are written
// down (docs/scene-reference.md is generated from there).

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "taut/base/error.h"
#include "taut/base/types.h"
#include "taut/contact/contact_options.h"
#include "taut/contact/solid.h"
#include "taut/element/external.h"
#include "taut/element/spring_material.h"
#include "taut/mesh/grid.h"
#include "taut/mesh/tube.h"
#include "taut/solve/solver_options.h"
#include "taut/step/integrator_options.h"

namespace taut {

struct TimeOptions {
  double step = 5e-3;  // s
  int frames = 100;    // pictures to write after the first (frame 0 is the start)
  int steps_per_frame = 1;
  IntegratorKind integrator = IntegratorKind::semi_implicit_euler;
  NewtonOptions newton;
  // share of a spring's rest length, element/overshoot.h; beyond it the step is halved
  double overshoot_limit = 0.05;
  int max_halvings = 4;
  bool operator==(const TimeOptions&) const = default;
};

// Which nodes a pin holds. Exactly one way is used.
struct NodeSelection {
  std::vector<Index> nodes;          // by index
  std::vector<std::string> corners;  // of a grid: "u0v0", "u1v0", "u0v1", "u1v1"
  std::vector<std::string> edges;    // of a grid: "u0", "u1", "v0", "v1"
  bool operator==(const NodeSelection&) const = default;
};

// A pin holds nodes still, or carries them along a path: the displacement of the path since time 0
// is added to where the nodes started, and they turn about `pivot` with the key frames' rotation.
// Between key frames as Solid. After `release` (s) the nodes are free.
struct Pin {
  NodeSelection where;
  std::vector<KeyFrame> key_frames;
  Vec3 pivot = Vec3::Zero();
  double release = -1.0;  // negative: never
  bool operator==(const Pin&) const = default;
};

struct Cloth {
  std::string name;
  // Shape: a grid (Provot springs), or a tube or a triangle mesh from a file (stretch on edges,
  // bend across edges).
  bool from_file = false;
  bool is_tube = false;
  GridShape grid;
  TubeShape tube;
  bool is_grid() const { return !from_file && !is_tube; }
  // OBJ, PLY or USD; absolute after reading (in a file: relative to it)
  std::filesystem::path mesh;
  std::string prim;        // which mesh of a USD file; empty: its only one
  double scale = 1.0;      // of the file's coordinates; 0.01 for centimetres
  Pose placement;          // applied after scale
  bool y_up = false;       // turn Y-up files to Taut's Z-up
  double node_mass = 0.0;  // kg, each; or
  // kg/m², spread over the triangles' corners; exactly one of the two is > 0
  double density = 0.0;
  double drag = 0.0;  // kg/s a node: force -drag (v - wind)
  // kg/(m² s): force c A (n·(wind - v)) n on each triangle of area A and normal n, a third to each
  // node
  double wind_pressure = 0.0;
  SpringMaterial material;
  std::vector<Pin> pins;
  Vec3 velocity = Vec3::Zero();  // m/s at the start
  // m: each start coordinate is moved by up to this, from `jitter_seed`
  double jitter = 0.0;
  unsigned jitter_seed = 1;
  bool operator==(const Cloth&) const = default;
};

// A solid of a scene file, with the files of one that is a mesh.
struct SolidEntry : Solid {
  // OBJ, PLY or USD file, in the last which prim; its lengths' scale and upward axis; and where it
  // deforms, a file of positions (io/motion_file.h), samples a second.
  std::filesystem::path mesh, motion;
  std::string prim;
  double scale = 1.0;
  bool y_up = false;
  double motion_rate = 24.0;
  bool operator==(const SolidEntry&) const = default;
};

// Where a scene file says something, by path ("cloth.0.pin.1.nodes"), for messages about what is
// found out later; no part of what the scene is.
struct WrittenAt : std::map<std::string, SourcePlace> {
  bool operator==(const WrittenAt&) const { return true; }
};

struct Scene {
  std::string title;             // one line, shown in reports and pictures
  std::filesystem::path folder;  // of the scene file
  TimeOptions time;
  SolverOptions solver{.name = "auto"};
  ContactOptions contact;
  Vec3 gravity = Vec3(0, 0, -9.81);  // m/s²
  WindOptions wind;
  std::vector<Cloth> cloths;
  std::vector<SolidEntry> solids;
  WrittenAt places;
  bool operator==(const Scene&) const = default;
};

}  // namespace taut
