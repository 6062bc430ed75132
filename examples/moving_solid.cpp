// A cloth falls on a cube, a triangle mesh, which then turns under it; steered step by step, saved
// half way and gone on with in a second simulation. Any mesh will do that has arrays of positions
// and triangles.
#include <taut/taut.h>

#include <cstdio>

namespace {

taut::TriangleMesh cube(double edge) {
  taut::TriangleMesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.positions.push_back(edge * taut::Vec3((k & 1) - 0.5, (k >> 1 & 1) - 0.5, (k >> 2) - 0.5));
  const int sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& s : sides) {
    mesh.triangles.push_back({s[0], s[1], s[2]});
    mesh.triangles.push_back({s[0], s[2], s[3]});
  }
  return mesh;
}

// Where the cube is at the end of step k: it stands still for 0.3 s, then turns.
taut::Pose pose_at(int k) {
  taut::Pose pose;
  pose.rotation = Eigen::AngleAxisd(0.01 * std::max(0, k - 60), taut::Vec3::UnitZ());
  return pose;
}

bool run(taut::Simulation& simulation, taut::SolidHandle solid, int from, int to) {
  for (int k = from + 1; k <= to; ++k) {
    simulation.move(solid, pose_at(k));
    const taut::StepReport report = simulation.step(5e-3);
    if (!report.ok()) return std::puts(report.message().c_str()), false;
  }
  return true;
}

}  // namespace

int main() {
  taut::World world;
  const auto cloth = world.add_cloth(
      {.mesh = taut::make_grid(
           {.nu = 31, .nv = 31, .origin = {-0.3, -0.3, 0.11}, .u = {0.6, 0, 0}, .v = {0, 0.6, 0}}),
       .density = 0.15,
       .material = {.k_stretch = 600, .k_bend = 0.01}});
  const auto solid = world.add_solid({.friction = 0.5}, {.mesh = cube(0.2)});
  taut::Simulation first(world), second(world);
  if (!run(first, solid, 0, 80)) return 1;
  second.load(first.save());
  if (!run(first, solid, 80, 120) || !run(second, solid, 80, 120)) return 1;
  const bool same = first.save() == second.save();
  std::printf("z of a corner %.2f m; both simulations have the same bits: %s\n",
              first.positions(cloth)[0].z(), same ? "yes" : "no");
  return same ? 0 : 1;
}
