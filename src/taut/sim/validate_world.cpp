// World::validate: numbers by the declarations of sim/describe.h; meshes, nodes and names here.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "taut/mesh/topology.h"
#include "taut/sim/describe.h"
#include "taut/sim/validator.h"
#include "taut/sim/world.h"

namespace taut {

namespace {

class Judge {
 public:
  explicit Judge(const World& world) : world_(world) {}

  void run() {
    options();
    if (world_.cloths().empty())
      v_.complain("cloth",
                  " is missing; expected here: A piece of cloth; a scene has at least one.");
    for (std::size_t c = 0; c < world_.cloths().size(); ++c) cloth(c);
    for (std::size_t s = 0; s < world_.solids().size(); ++s) solid(s);
    std::vector<int> pins_of(world_.cloths().size(), 0);
    for (const WorldPin& p : world_.pins()) pin(p, pins_of);
    v_.finish();
  }

 private:
  void options() {
    Vec3 gravity = world_.gravity;
    ContactOptions contact = world_.contact;
    WindOptions wind = world_.wind;
    std::vector<std::string> cloths, solids;
    for (const ClothOptions& cloth : world_.cloths()) cloths.push_back(cloth.name);
    for (const Solid& solid : world_.solids()) solids.push_back(solid.name);
    v_.inside("", [&] {
      describe_gravity(v_, gravity);
      v_.table("contact", {}, [&] { describe_contact(v_, contact); });
      v_.table("wind", {}, [&] { describe_wind(v_, wind); });
      check_names(v_, "cloth", cloths);
      check_names(v_, "solid", solids);
      check_pairs(v_, contact.pairs, cloths, solids);
    });
  }

  bool sound_triangles(const std::string& path, const TriangleMesh& mesh) {
    const auto count = static_cast<Index>(mesh.positions.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const Index vertex : mesh.triangles[t])
        if (vertex < 0 || vertex >= count) {
          v_.complain(path, fmt::format(": triangle {} names vertex {}, but the mesh has {} "
                                        "vertices, counted from 0",
                                        t, vertex, count));
          return false;
        }
    return finite(path, "position", mesh.positions);
  }

  void sound_shape(const std::string& path, const TriangleMesh& mesh) {
    try {
      check_cloth_mesh(mesh, path);
    } catch (const InputError& error) {
      v_.complain_whole(path, error.what());
    }
  }

  bool finite(const std::string& path, const char* what, std::span<const Vec3> list) {
    for (std::size_t i = 0; i < list.size(); ++i)
      if (!list[i].allFinite()) {
        v_.complain(path, fmt::format(": {} {} is ({}, {}, {}), three finite numbers in m were "
                                      "expected",
                                      what, i, list[i].x(), list[i].y(), list[i].z()));
        return false;
      }
    return true;
  }

  void cloth(std::size_t c) {
    ClothOptions cloth = world_.cloths()[c];
    const std::string path = fmt::format("cloth.{}.", c);
    v_.inside(path, [&] {
      describe_cloth_name(v_, cloth.name);
      describe_cloth_values(v_, {cloth.node_mass, cloth.density, cloth.material, cloth.drag,
                                 cloth.wind_pressure, cloth.velocity, !cloth.masses.empty()});
    });
    const TriangleMesh& mesh = world_.cloths()[c].mesh;
    const std::size_t nodes = mesh.positions.size();
    if (mesh.triangles.empty())
      v_.complain(path + "mesh", fmt::format(": {} vertices and no triangle found: a cloth has at "
                                             "least one triangle",
                                             nodes));
    else if (sound_triangles(path + "mesh", mesh))
      sound_shape(path + "mesh", mesh);
    if (!mesh.texcoords.empty() && mesh.texcoords.size() != nodes)
      v_.complain(path + "mesh", count_text("texcoords", mesh.texcoords.size(), nodes));
    masses(path, world_.cloths()[c]);
    if (!cloth.start.empty() && cloth.start.size() != nodes)
      v_.complain(path + "start", count_text("positions", cloth.start.size(), nodes));
    finite(path + "start", "position", cloth.start);
    grid(path, cloth);
  }

  static std::string count_text(const char* what, std::size_t found, std::size_t nodes) {
    return fmt::format(": {} {} found, one for each of the mesh's {} vertices was expected", found,
                       what, nodes);
  }

  void masses(const std::string& path, const ClothOptions& cloth) {
    if (cloth.masses.empty()) return;
    if (cloth.density != 0.0 || cloth.node_mass != 0.0)
      v_.complain(path + "masses",
                  ": masses stand beside density or node_mass: keep exactly one of the three");
    if (cloth.masses.size() != cloth.mesh.positions.size())
      v_.complain(path + "masses",
                  count_text("masses", cloth.masses.size(), cloth.mesh.positions.size()));
    for (std::size_t i = 0; i < cloth.masses.size(); ++i)
      if (const std::string problem =
              problem_of(cloth.masses[i], {.unit = "kg", .min = 0, .max = 1e6, .above_min = true});
          !problem.empty())
        return v_.complain(fmt::format("{}masses.{}", path, i), problem);
  }

  void grid(const std::string& path, const ClothOptions& cloth) {
    const auto [nu, nv] = cloth.grid;
    if (nu == 0 && nv == 0) return;
    if (nu < 2 || nv < 2 || Offset{nu} * nv != std::ssize(cloth.mesh.positions))
      v_.complain(
          path + "grid",
          fmt::format(": {} x {} nodes found, but the mesh has {} vertices; give the nu and "
                      "nv of make_grid, at least 2 each, or zeros for any other mesh",
                      nu, nv, cloth.mesh.positions.size()));
  }

  void solid(std::size_t s) {
    Solid solid = world_.solids()[s];
    const SolidSurface& surface = world_.surfaces()[s];
    const std::string path = fmt::format("solid.{}.", s);
    v_.inside(path, [&] {
      describe_solid_shape(v_, solid);
      describe_solid_motion(v_, solid);
    });
    if (solid.shape != SolidShape::mesh) return;
    if (surface.mesh.triangles.empty())
      v_.complain(path + "mesh", ": no triangle found: add a mesh solid with its surface");
    else if (sound_triangles(path + "mesh", surface.mesh))
      for (const Index triangle : find_faults(surface.mesh).repeated_vertex) {
        v_.complain(path + "mesh",
                    fmt::format(": triangle {} names a vertex twice; remove it", triangle + 1));
        break;
      }
    if (!(surface.rate > 0.0 && std::isfinite(surface.rate)))
      v_.complain(path + "motion_rate",
                  problem_of(surface.rate, {.unit = "Hz", .min = 0, .above_min = true}));
    for (std::size_t k = 0; k < surface.samples.size(); ++k) {
      const std::string at = fmt::format("{}samples.{}", path, k);
      if (surface.samples[k].size() != surface.mesh.positions.size())
        return v_.complain(
            at, count_text("positions", surface.samples[k].size(), surface.mesh.positions.size()));
      if (!finite(at, "position", surface.samples[k])) return;
    }
  }

  void pin(const WorldPin& p, std::vector<int>& pins_of) {
    const int cloths = static_cast<int>(world_.cloths().size());
    if (p.cloth.index < 0 || p.cloth.index >= cloths)
      return v_.complain("pin", fmt::format(": it is of cloth {}, but there are {} cloths: give a "
                                            "handle that add_cloth of this World returned",
                                            p.cloth.index, cloths));
    const auto c = static_cast<std::size_t>(p.cloth.index);
    const std::string path = fmt::format("cloth.{}.pin.{}.", c, pins_of[c]++);
    const auto count = static_cast<Index>(world_.cloths()[c].mesh.positions.size());
    if (p.nodes.empty())
      v_.complain(path + "nodes",
                  ": empty, so the pin holds nothing: name what it holds, or remove the pin");
    for (const Index node : p.nodes)
      if (node < 0 || node >= count) {
        v_.complain(path + "nodes",
                    fmt::format(": a pin holds node {}, but the nodes of cloth '{}' are 0 to {}; "
                                "name nodes from 0, vertex 1 of a file is node 0",
                                node, world_.cloths()[c].name, count - 1));
        break;
      }
    PinPath copy = p.path;
    v_.inside(path, [&] { describe_pin_path(v_, copy.pivot, copy.release, copy.key_frames); });
  }

  const World& world_;
  Validator v_;
};

}  // namespace

void World::validate() const { Judge(*this).run(); }

}  // namespace taut
