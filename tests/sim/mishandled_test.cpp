// Whatever a program puts into a World or does to a Simulation: an InputError, a report that is not
// ok, or a motion, but no crash.

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "sim/hanging_sheet.h"
#include "taut/base/error.h"

namespace taut::test {
namespace {

class Mishandler {
 public:
  explicit Mishandler(unsigned seed) : random_(seed) {}

  std::size_t below(std::size_t n) { return random_() % n; }
  double number() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    const double odd[] = {0.0,  -0.0,   1.0, -1.0, 1e-300,       1e300, -1e300, 1e9,
                          1e-9, 5e-324, inf, -inf, std::nan(""), 0.01,  100.0,  1e6};
    return odd[below(std::size(odd))];
  }
  Vec3 vector() { return {number(), number(), number()}; }
  Index index() {
    const Index odd[] = {0,
                         1,
                         8,
                         80,
                         81,
                         -1,
                         1000000,
                         std::numeric_limits<Index>::max(),
                         std::numeric_limits<Index>::min()};
    return odd[below(std::size(odd))];
  }

  void spoil(ClothOptions& c) {
    switch (below(14)) {
      case 0:
        c.mesh.positions[below(c.mesh.positions.size())] = vector();
        break;
      case 1:
        c.mesh.triangles[below(c.mesh.triangles.size())][below(3)] = index();
        break;
      case 2:
        c.mesh.positions.resize(below(c.mesh.positions.size()));
        break;
      case 3:
        c.mesh.triangles.resize(below(3));
        break;
      case 4:
        c.density = number();
        break;
      case 5:
        c.node_mass = number();
        break;
      case 6:
        c.masses.assign(below(2) ? 81 : 5, number());
        break;
      case 7:
        c.material.k_stretch = number(), c.material.k_bend = number();
        break;
      case 8:
        c.material.bend_model = BendModel::choi_ko, c.material.bend_cap = number();
        break;
      case 9:
        c.grid = {index(), index()};
        break;
      case 10:
        c.drag = number(), c.wind_pressure = number();
        break;
      case 11:
        c.velocity = vector();
        break;
      case 12:
        c.start.assign(below(2) ? 81 : 4, vector());
        break;
      default:
        c.material.compression = static_cast<Compression>(index());
        break;
    }
  }

  void spoil(World& w) {
    Solid solid;
    solid.shape = static_cast<SolidShape>(below(6));
    solid.radius = number(), solid.height = number(), solid.size = vector();
    switch (below(8)) {
      case 0:
        w.gravity = vector();
        break;
      case 1:
        w.wind.velocity = vector();
        break;
      case 2:
        w.pin({static_cast<int>(index())}, {index()});
        break;
      case 3:
        w.pin({0}, {index(), index()}, {.pivot = vector(), .release = number()});
        break;
      case 4:
        w.add_solid(solid);
        break;
      case 5:
        w.add_solid(solid, {.mesh = {{vector(), vector(), vector()}, {{0, 1, 2}}, {}}});
        break;
      case 6:
        w.contact.thickness = number();
        break;
      default:
        w.contact.max_passes = static_cast<int>(index());
        break;
    }
  }

  void mishandle(Simulation& s) {
    const int handle = static_cast<int>(index());
    Pose pose;
    pose.translation = vector();
    if (below(2)) pose.rotation.coeffs().setConstant(number());
    switch (below(8)) {
      case 0:
        s.set_gravity(vector());
        break;
      case 1:
        s.move(PinHandle{handle}, vector());
        break;
      case 2:
        s.move(SolidHandle{handle}, pose);
        break;
      case 3:
        s.set_velocities({0}, std::vector<Vec3>(below(2) ? 81 : 7, vector()));
        break;
      case 4:
        s.set_forces({0}, std::vector<Vec3>(81, vector()));
        break;
      case 5:
        s.set_material({0}, {.k_stretch = number(), .k_shear = number()});
        break;
      case 6:
        s.pin({0}, {index()});
        break;
      default:
        s.step(number());
        break;
    }
  }

 private:
  std::mt19937 random_;
};

TEST(Mishandled, NeitherWorldsNorSimulationsCrash) {
  int refused = 0, ran = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Mishandler hand(seed);
    HangingSheet sheet;
    ClothOptions second = sheet.world.cloths()[0];
    second.name = "second";
    for (Vec3& x : second.mesh.positions) x.z() += 1.0;
    if (seed % 2) hand.spoil(second);
    if (seed % 3) sheet.world.add_cloth(second);
    if (seed % 5 == 0) hand.spoil(sheet.world);
    try {
      Simulation simulation(sheet.world, {.max_halvings = 1});
      for (int k = 0; k < 3; ++k) {
        if (seed % 2 == 0) hand.mishandle(simulation);
        simulation.step(4e-3);
      }
      ++ran;
    } catch (const InputError& error) {
      EXPECT_GT(std::string(error.what()).size(), 20u);
      ++refused;
    }
  }
  EXPECT_GT(ran, 8);
  EXPECT_GT(refused, 15);
}

}  // namespace
}  // namespace taut::test
