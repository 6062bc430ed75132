#include "taut/scene/scene_world.h"

#include <algorithm>
#include <random>

#include "taut/base/checksum.h"
#include "taut/base/error.h"
#include "taut/io/mesh_file.h"
#include "taut/io/motion_file.h"
#include "taut/mesh/mesh_sum.h"
#include "taut/mesh/topology.h"
#include "taut/scene/cloth_shape.h"
#include "taut/scene/schema.h"
#include "taut/sim/validator.h"

namespace taut {

namespace fs = std::filesystem;

namespace {

// Uniform in [-1, 1) with the same bits everywhere: std::uniform_real_distribution is left to the
// library's taste.
double symmetric_random(std::mt19937_64& generator) {
  return static_cast<double>(generator() >> 11) * 0x1.0p-52 - 1.0;
}

std::vector<Vec3> start_of(const Cloth& cloth, const TriangleMesh& mesh) {
  std::vector<Vec3> start;
  start.reserve(mesh.positions.size());
  std::mt19937_64 generator(cloth.jitter_seed);
  for (const Vec3& rest : mesh.positions) {
    Vec3 x = cloth.placement.to_world(rest);
    if (cloth.jitter > 0.0)
      for (int c = 0; c < 3; ++c) x[c] += cloth.jitter * symmetric_random(generator);
    start.push_back(x);
  }
  return start;
}

ClothOptions options_of(const Cloth& cloth, const fs::path& folder, std::vector<InputFile>& files) {
  ClothOptions options;
  options.mesh = rest_shape(cloth, folder);
  if (cloth.from_file) files.push_back({cloth.mesh, sum_of(options.mesh)});
  options.start = start_of(cloth, options.mesh);
  options.density = cloth.density;
  options.node_mass = cloth.node_mass;
  options.material = cloth.material;
  if (cloth.is_grid()) options.grid = {cloth.grid.nu, cloth.grid.nv};
  options.drag = cloth.drag;
  options.wind_pressure = cloth.wind_pressure;
  options.velocity = cloth.velocity;
  options.name = cloth.name;
  return options;
}

void turn_and_scale(std::vector<Vec3>& positions, const SolidEntry& solid) {
  for (Vec3& x : positions) {
    if (solid.y_up) x = Vec3(x.x(), -x.z(), x.y());
    x *= solid.scale;
  }
}

fs::path found(const fs::path& path, const fs::path& folder) {
  return path.is_absolute() ? path : folder / path;
}

Index corner_node(const GridShape& g, const std::string& name) {
  if (name.size() != 4 || name[0] != 'u' || name[2] != 'v' ||
      std::string("01").find(name[1]) == std::string::npos ||
      std::string("01").find(name[3]) == std::string::npos)
    throw InputError("corners: \"" + name +
                     "\" is not known: expected one of \"u0v0\", \"u1v0\", \"u0v1\", \"u1v1\"");
  return g.node(name[1] == '1' ? g.nu - 1 : 0, name[3] == '1' ? g.nv - 1 : 0);
}

void check_edge(const std::string& name) {
  if (name.size() == 2 && (name[0] == 'u' || name[0] == 'v') && (name[1] == '0' || name[1] == '1'))
    return;
  throw InputError("edges: \"" + name +
                   "\" is not known: expected one of \"u0\", \"u1\", \"v0\", \"v1\"");
}

// Where each sentence belongs in the file that the scene came from.
[[noreturn]] void throw_located(const InvalidWorld& error, const WrittenAt& places) {
  std::string text;
  for (const ValueComplaint& complaint : error.complaints()) {
    const auto place = places.find(complaint.path);
    text += text.empty() ? "" : "\n";
    text += place == places.end() ? complaint.text : located(place->second, complaint.text);
  }
  throw InputError(text);
}

void judge(const Scene& scene) {
  Scene copy = scene;
  Validator validator;
  validator.inside("", [&] { describe(validator, copy); });
  validator.finish();
}

}  // namespace

std::vector<Index> selected_nodes(const Cloth& cloth, const NodeSelection& where) {
  std::vector<Index> nodes = where.nodes;
  const GridShape& g = cloth.grid;
  for (const std::string& corner : where.corners) nodes.push_back(corner_node(g, corner));
  for (const std::string& edge : where.edges) {
    check_edge(edge);
    if (cloth.is_tube) {
      const Index row = edge == "v0" ? 0 : cloth.tube.along - 1;
      for (Index k = 0; k < cloth.tube.around; ++k) nodes.push_back(row * cloth.tube.around + k);
      continue;
    }
    const bool along_v = edge[0] == 'u';
    const Index count = along_v ? g.nv : g.nu;
    const Index fixed = edge[1] == '0' ? 0 : (along_v ? g.nu : g.nv) - 1;
    for (Index k = 0; k < count; ++k)
      nodes.push_back(along_v ? g.node(fixed, k) : g.node(k, fixed));
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

SolidSurface read_surface(const SolidEntry& solid, const fs::path& folder,
                          std::vector<InputFile>* files) {
  SolidSurface surface;
  surface.mesh = read_mesh(found(solid.mesh, folder), solid.prim);
  const MeshFaults faults = find_faults(surface.mesh);
  for (const Index triangle : faults.repeated_vertex)
    throw InputError(
        {found(solid.mesh, folder).string()},
        "triangle " + std::to_string(triangle + 1) + " names a vertex twice; remove it");
  if (files) files->push_back({solid.mesh, sum_of(surface.mesh)});
  turn_and_scale(surface.mesh.positions, solid);
  surface.rate = solid.motion_rate;
  if (solid.motion.empty()) return surface;
  surface.samples =
      read_motion(found(solid.motion, folder), static_cast<Index>(surface.mesh.positions.size()));
  Checksum motion;
  for (auto& sample : surface.samples) {
    motion.add_items(std::span<const Vec3>(sample));
    turn_and_scale(sample, solid);
  }
  if (files) files->push_back({solid.motion, motion.value()});
  return surface;
}

SceneWorld make_world(const Scene& scene) {
  SceneWorld result;
  World& world = result.world;
  try {
    judge(scene);
    world.gravity = scene.gravity;
    world.wind = scene.wind;
    world.contact = scene.contact;
    for (const Cloth& cloth : scene.cloths) {
      const ClothHandle handle = world.add_cloth(options_of(cloth, scene.folder, result.files));
      for (const Pin& pin : cloth.pins)
        world.pin(handle, selected_nodes(cloth, pin.where),
                  {pin.key_frames, pin.pivot, pin.release});
    }
    for (const SolidEntry& solid : scene.solids) {
      if (solid.shape == SolidShape::mesh)
        world.add_solid(solid, read_surface(solid, scene.folder, &result.files));
      else
        world.add_solid(solid);
    }
    world.validate();
  } catch (const InvalidWorld& error) {
    throw_located(error, scene.places);
  }
  return result;
}

SimulationOptions simulation_options(const Scene& scene) {
  return {scene.solver, scene.time.integrator, scene.time.newton, scene.time.overshoot_limit,
          scene.time.max_halvings};
}

}  // namespace taut
