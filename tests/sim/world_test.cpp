#include <gtest/gtest.h>

#include <limits>

#include "sim/hanging_sheet.h"
#include "taut/sim/validator.h"

namespace taut::test {
namespace {

// What is said of a world; "" when nothing is.
std::string complaint(const World& world) {
  try {
    world.validate();
  } catch (const InvalidWorld& error) {
    return error.what();
  }
  return "";
}

struct Fault {
  const char* says;
  void (*make)(HangingSheet&, ClothOptions&);
};

// Every fault is put into the second cloth of a world that is sound without it.
void expect_fault(const Fault& fault) {
  HangingSheet sheet;
  ClothOptions second = sheet.world.cloths()[0];
  second.name = "second";
  second.start = second.mesh.positions;
  for (Vec3& x : second.start) x.z() += 1.0;
  fault.make(sheet, second);
  sheet.world.add_cloth(second);
  EXPECT_NE(complaint(sheet.world).find(fault.says), std::string::npos)
      << "expected: " << fault.says << "\nfound: " << complaint(sheet.world);
  EXPECT_EQ(complaint(sheet.world).find('\n'), std::string::npos) << complaint(sheet.world);
  EXPECT_THROW(Simulation(sheet.world), InvalidWorld);
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(World, SaysWhatIsWrongWithACloth) {
  const Fault faults[] = {
      {"cloth.1.density = -1 kg/m² is out of range: expected above 0, at most 1e+06 kg/m²",
       [](HangingSheet&, ClothOptions& c) { c.density = -1; }},
      {"cloth.1 needs exactly one of node_mass, density, it has none: add one",
       [](HangingSheet&, ClothOptions& c) { c.density = 0; }},
      {"cloth.1 needs exactly one of node_mass, density, it has node_mass and density",
       [](HangingSheet&, ClothOptions& c) { c.node_mass = 1e-3; }},
      {"cloth.1.k_stretch = nan is not a finite number",
       [](HangingSheet&, ClothOptions& c) { c.material.k_stretch = nan; }},
      {"cloth.1.velocity = inf is not a finite number",
       [](HangingSheet&, ClothOptions& c) {
         c.velocity.x() = std::numeric_limits<double>::infinity();
       }},
      {"cloth.1.mesh: 81 vertices and no triangle found",
       [](HangingSheet&, ClothOptions& c) { c.mesh.triangles.clear(); }},
      {"cloth.1.mesh: triangle 3 names vertex 81, but the mesh has 81 vertices",
       [](HangingSheet&, ClothOptions& c) { c.mesh.triangles[3][1] = 81; }},
      {"cloth.1.mesh: triangle 3 names vertex -1",
       [](HangingSheet&, ClothOptions& c) { c.mesh.triangles[3][1] = -1; }},
      {"cloth.1.mesh: position 5 is (nan, ",
       [](HangingSheet&, ClothOptions& c) { c.mesh.positions[5].x() = nan; }},
      {"cloth.1.mesh: triangle 4 (vertices ",
       [](HangingSheet&, ClothOptions& c) { c.mesh.triangles[3][1] = c.mesh.triangles[3][0]; }},
      {"cloth.1.start: 3 positions found, one for each of the mesh's 81 vertices was expected",
       [](HangingSheet&, ClothOptions& c) { c.start.resize(3); }},
      {"cloth.1.masses: 3 masses found",
       [](HangingSheet&, ClothOptions& c) { c.density = 0, c.masses.assign(3, 1e-3); }},
      {"cloth.1.masses.7 = 0 kg is out of range: expected above 0",
       [](HangingSheet&, ClothOptions& c) {
         c.density = 0, c.masses.assign(81, 1e-3), c.masses[7] = 0;
       }},
      {"cloth.1.masses: masses stand beside density",
       [](HangingSheet&, ClothOptions& c) { c.masses.assign(81, 1e-3); }},
      {"cloth.1.grid: 9 x 8 nodes found, but the mesh has 81 vertices",
       [](HangingSheet&, ClothOptions& c) { c.grid = {9, 8}; }},
      {"cloth: two entries are named 'cloth_0'",
       [](HangingSheet&, ClothOptions& c) { c.name = "cloth_0"; }},
  };
  for (const Fault& fault : faults) expect_fault(fault);
}

TEST(World, SaysWhatIsWrongWithPinsSolidsAndOptions) {
  const Fault faults[] = {
      {"cloth.0.pin.1.nodes: a pin holds node 81, but the nodes of cloth 'cloth_0' are 0 to 80",
       [](HangingSheet& s, ClothOptions&) { s.world.pin(s.sheet, {81}); }},
      {"cloth.0.pin.1.nodes: empty",
       [](HangingSheet& s, ClothOptions&) { s.world.pin(s.sheet, {}); }},
      {"pin: it is of cloth 7, but there are 2 cloths",
       [](HangingSheet& s, ClothOptions&) { s.world.pin({7}, {0}); }},
      {"cloth.0.pin.1.key_frames: times must ascend",
       [](HangingSheet& s, ClothOptions&) {
         s.world.pin(s.sheet, {4}, {.key_frames = {{1.0, {}}, {0.5, {}}}});
       }},
      {"solid.1.radius = 0 m is out of range: expected above 0",
       [](HangingSheet& s, ClothOptions&) { s.world.add_solid({.radius = 0}); }},
      {"solid.1.mesh: no triangle found",
       [](HangingSheet& s, ClothOptions&) { s.world.add_solid({}, {}); }},
      {"gravity = nan is not a finite number",
       [](HangingSheet& s, ClothOptions&) { s.world.gravity.z() = nan; }},
      {"contact.thickness = -1 m is out of range",
       [](HangingSheet& s, ClothOptions&) { s.world.contact.thickness = -1; }},
      {"contact.pair number 0 (from 0): there is no cloth named 'nobody'",
       [](HangingSheet& s, ClothOptions&) {
         s.world.contact.pairs.push_back({.cloth = "nobody", .with = "second", .friction = 1});
       }},
      {"wind.gust = -1 is out of range",
       [](HangingSheet& s, ClothOptions&) { s.world.wind.gust = -1; }},
  };
  for (const Fault& fault : faults) expect_fault(fault);
}

TEST(World, WithoutClothIsRefused) {
  EXPECT_NE(complaint(World()).find("a scene has at least one"), std::string::npos);
}

TEST(World, CollectsAllThatIsWrong) {
  HangingSheet sheet;
  sheet.world.gravity.z() = nan;
  sheet.world.wind.gust = 1e9;
  try {
    sheet.world.validate();
    FAIL();
  } catch (const InvalidWorld& error) {
    ASSERT_EQ(error.complaints().size(), 2u);
    EXPECT_EQ(error.complaints()[0].path, "gravity");
    EXPECT_EQ(error.complaints()[1].path, "wind.gust");
  }
}

std::string refusal(const SimulationOptions& options) {
  try {
    Simulation simulation(HangingSheet().world, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SimulationOptions, AreJudgedAsInAScene) {
  EXPECT_NE(refusal({.solver = {.name = "core_pgc"}}).find("did you mean 'core_pcg'"),
            std::string::npos);
  EXPECT_NE(refusal({.solver = {.tolerance = -1}}).find("solver.tolerance = -1 is out of range"),
            std::string::npos);
  EXPECT_NE(refusal({.solver = {.core = "middle"}}).find("\"middle\" is not known"),
            std::string::npos);
  EXPECT_NE(refusal({.solver = {.ssor_omega = 2.0}}).find("ssor_omega"), std::string::npos);
  EXPECT_NE(refusal({.max_halvings = -1}).find("max_halvings = -1 is out of range"),
            std::string::npos);
  EXPECT_EQ(refusal({}), "");
}

}  // namespace
}  // namespace taut::test
