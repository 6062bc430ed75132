#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "sim/hanging_sheet.h"
#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/step/state.h"

namespace taut::test {
namespace {

constexpr double h = 4e-3;

// What a program does at step k: everything that may change.
void steer(Simulation& simulation, const HangingSheet& sheet, int k) {
  simulation.move(sheet.pin, Vec3(0.002 * std::sin(0.3 * k), 0, 0.001 * k));
  if (k % 7 == 3) {
    Pose pose;
    pose.translation = Vec3(0.2, 0.2, -0.12 + 0.002 * k);
    simulation.move(sheet.ball, pose);
  }
  if (k == 11) simulation.set_gravity(Vec3(0.5, 0, -9));
  if (k == 13) simulation.set_wind({.velocity = Vec3(1, 0, 0)});
  if (k == 15) simulation.set_material(sheet.sheet, {.k_stretch = 900, .k_shear = 40});
  if (k == 17) simulation.pin(sheet.sheet, {76});
  if (k == 19) simulation.set_forces(sheet.sheet, std::vector<Vec3>(81, Vec3(0, 1e-4, 0)));
}

double length_of(int k) { return k % 5 == 4 ? 0.5 * h : h; }

void go(Simulation& simulation, const HangingSheet& sheet, int from, int to) {
  for (int k = from; k < to; ++k) {
    steer(simulation, sheet, k);
    const StepReport report = simulation.step(length_of(k));
    ASSERT_TRUE(report.ok()) << report.message();
  }
}

void expect_same(const Simulation& a, const Simulation& b) {
  EXPECT_EQ(a.state().x, b.state().x);
  EXPECT_EQ(a.state().v, b.state().v);
  EXPECT_EQ(a.time(), b.time());
  EXPECT_TRUE(a.save() == b.save());
}

constexpr int steps = 30;

TEST(Snapshot, GoesOnToTheSameBitsInAnotherThreadBesideOthers) {
  std::mt19937 random(7);
  const HangingSheet sheet;
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    Simulation whole(sheet.world);
    std::vector<Snapshot> at(steps + 1);
    for (int k = 0; k < steps; ++k) {
      at[static_cast<std::size_t>(k)] = whole.save();
      go(whole, sheet, k, k + 1);
    }
    for (int trial = 0; trial < 10; ++trial) {
      const int from = static_cast<int>(random() % steps);
      std::vector<std::unique_ptr<Simulation>> others;
      std::vector<std::thread> beside;
      for (int other = 0; other < 3; ++other)
        others.push_back(std::make_unique<Simulation>(HangingSheet(7 + other).world));
      Simulation resumed(sheet.world);
      for (auto& other : others)
        beside.emplace_back([&other] {
          for (int k = 0; k < 10; ++k) EXPECT_TRUE(other->step(h).ok());
        });
      beside.emplace_back([&] {
        resumed.load(at[static_cast<std::size_t>(from)]);
        go(resumed, sheet, from, steps);
      });
      for (std::thread& t : beside) t.join();
      expect_same(whole, resumed);
    }
  }
  set_thread_count(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
}

TEST(Snapshot, KeepsTheAdaptiveSplitAndTheHistoryOfIntegrators) {
  const HangingSheet sheet;
  for (const IntegratorKind kind :
       {IntegratorKind::bdf2, IntegratorKind::imex_adaptive, IntegratorKind::newton}) {
    Simulation whole(sheet.world, {.integrator = kind}), resumed(sheet.world, {.integrator = kind});
    go(whole, sheet, 0, 10);
    resumed.load(whole.save());
    go(whole, sheet, 10, 20);
    go(resumed, sheet, 10, 20);
    expect_same(whole, resumed);
  }
}

TEST(Snapshot, GoesBackInTime) {
  const HangingSheet sheet;
  Simulation simulation(sheet.world), fresh(sheet.world);
  const Snapshot start = simulation.save();
  go(simulation, sheet, 0, 20);
  simulation.load(start);
  go(simulation, sheet, 0, 20);
  go(fresh, sheet, 0, 20);
  expect_same(simulation, fresh);
}

TEST(Snapshot, OfAnotherWorldOrDamagedIsRefused) {
  const HangingSheet sheet, other(8);
  Simulation simulation(sheet.world), another(other.world);
  EXPECT_THROW(another.load(simulation.save()), InputError);
  const Snapshot whole = simulation.save();
  EXPECT_NO_THROW(simulation.load(whole));
  for (std::size_t at = 0; at < whole.bytes.size(); at += 97) {
    Snapshot damaged = whole;
    damaged.bytes[at] = static_cast<char>(damaged.bytes[at] ^ 1);
    EXPECT_THROW(simulation.load(damaged), InputError);
    EXPECT_THROW(simulation.load({whole.bytes.substr(0, at)}), InputError);
  }
  EXPECT_TRUE(simulation.save() == whole);
}

TEST(Snapshot, OfAnotherSolverChangesNothing) {
  const HangingSheet sheet;
  Simulation by_auto(sheet.world), direct(sheet.world, {.solver = {.name = "block_cholesky"}});
  go(by_auto, sheet, 0, 12);
  go(direct, sheet, 0, 3);
  const Snapshot before = direct.save();
  EXPECT_THROW(direct.load(by_auto.save()), InputError);
  EXPECT_TRUE(direct.save() == before);
}

}  // namespace
}  // namespace taut::test
