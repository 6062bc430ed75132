#pragma once
// A sheet that hangs by two corners above a ball, small enough to be stepped often.

#include "taut/mesh/grid.h"
#include "taut/sim/simulation.h"

namespace taut::test {

struct HangingSheet {
  World world;
  ClothHandle sheet;
  PinHandle pin;
  SolidHandle ball;

  explicit HangingSheet(Index side = 9) {
    const TriangleMesh mesh =
        make_grid({.nu = side, .nv = side, .u = Vec3(0.4, 0, 0), .v = Vec3(0, 0.4, 0)});
    sheet = world.add_cloth({.mesh = mesh,
                             .density = 0.15,
                             .material = {.k_stretch = 600, .k_shear = 30, .k_bend = 0.05},
                             .grid = {side, side}});
    pin = world.pin(sheet, {0, side - 1});
    Solid solid;
    solid.radius = 0.1;
    solid.friction = 0.3;
    solid.initial.translation = Vec3(0.2, 0.2, -0.12);
    ball = world.add_solid(solid);
  }
};

}  // namespace taut::test
