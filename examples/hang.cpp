// A sheet hangs by two corners, which are lifted 10 cm in half a second. Says where its lowest node
// is at the end.
#include <taut/taut.h>

#include <algorithm>
#include <cstdio>

int main() {
  taut::World world;
  const auto sheet = world.add_cloth({.mesh = taut::make_grid({.nu = 41, .nv = 41}),
                                      .density = 0.15,
                                      .material = {.k_stretch = 600}});
  const auto pin = world.pin(sheet, {1640, 1680});  // the upper corners
  taut::Simulation simulation(std::move(world));
  for (int k = 1; k <= 100; ++k) {
    simulation.move(pin, {0, 0, 0.001 * k});
    if (const auto report = simulation.step(5e-3); !report.ok())
      return std::puts(report.message().c_str()), 1;
  }
  double lowest = 1e9;
  for (const taut::Vec3& x : simulation.positions(sheet)) lowest = std::min(lowest, x.z());
  std::printf("after %g s the lowest node is at z = %.2f m\n", simulation.time(), lowest);
}
