// Checkpoints: what is written is read, and nothing but a whole checkpoint is taken for one.

#include "taut/results/checkpoint.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "taut/base/error.h"
#include "taut/sim/simulation_state.h"

namespace taut {
namespace {

SimulationState sample_state() {
  SimulationState c;
  c.clock = {.steps = 123, .origin = 0.25, .since_origin = 7, .h = 5e-3, .longest = 1e-2};
  c.state.time = 1.0 / 3.0;
  c.state.has_previous = true;
  c.state.x = {Vec3(1, -0.0, 1e-300), Vec3(4, 5, 6)};
  c.state.v = {Vec3(7, 8, 9), Vec3(0.1, 0.2, std::numeric_limits<double>::denorm_min())};
  c.state.x_prev = {Vec3(10, 11, 12), Vec3(13, 14, 15)};
  c.state.v_prev = {Vec3(16, 17, 18), Vec3(19, 20, 21)};
  c.state.last = {Vec3(22, 23, 24), Vec3(25, 26, 27)};
  c.contacts.node = {1}, c.contacts.solid = {2};
  c.contacts.sticking = {ContactStick{.sticks = 1, .wait = 5, .longest_wait = 6}};
  c.contacts.normal_force = {
      ContactForce{.normal = 3.5, .friction = {1, 2, 3}, .inverse_mass = 4.25}};
  c.solver_memory = {1.5, -0.0, 7e-300};
  c.surface_contact = {{{3, 8}, {0, 1}}, {{{1, 2, 3, 4}, {0.5f, -0.0f, 1e-30f}}}};
  c.gravity = Vec3(0, 1, -2);
  c.wind = {.velocity = Vec3(1, 2, 3), .gust = 0.5, .gust_frequency = 0.25};
  c.applied = {Vec3(1, 0, 0), Vec3(0, 1, 0)};
  c.materials = {{.k_stretch = 7, .bend_model = BendModel::choi_ko}};
  PinnedNodes pin;
  pin.nodes = {0}, pin.start = {Vec3(1, 1, 1)}, pin.held = false, pin.awaits_step = true;
  pin.from = {Vec3(1, 2, 3)}, pin.to = {Vec3(3, 2, 1)}, pin.t1 = 0.5;
  pin.carrier.key_frames = {{0.5, {}}};
  c.pins = {pin};
  Solid solid;
  solid.name = "ball", solid.radius = 0.5, solid.key_frames = {{1.5, {}}};
  c.solids = {solid};
  c.solid_targets = {Pose{.translation = Vec3(1, 2, 3)}};
  c.awaits_step = {1};
  c.deformations = {{{Vec3(1, 2, 3)}, {Vec3(4, 5, 6)}, 0.25, 0.5}};
  c.shape_targets = {{Vec3(9, 9, 9)}};
  return c;
}

Checkpoint sample() {
  Checkpoint c;
  c.scene = "title = \"a \\\"quoted\\\" µ\"\n";
  c.files = {0, ~std::uint64_t{0}, 42};
  c.frame = 45;
  c.snapshot.bytes = to_bytes(sample_state());
  return c;
}

std::string bytes_of(const Checkpoint& checkpoint) {
  std::ostringstream out;
  write(out, checkpoint);
  return out.str();
}

std::string refusal(const std::string& bytes) {
  try {
    parse_checkpoint(bytes, "run/checkpoint/state.bin");
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(Checkpoint, ComesBackWhole) {
  const Checkpoint c = sample(), again = parse_checkpoint(bytes_of(c), "state.bin");
  EXPECT_EQ(again.scene, c.scene);
  EXPECT_EQ(again.files, c.files);
  EXPECT_EQ(again.frame, 45);
  EXPECT_TRUE(again.snapshot == c.snapshot);
  EXPECT_EQ(bytes_of(again), bytes_of(c));
}

TEST(SimulationState, ComesBackWhole) {
  const SimulationState c = sample_state(), again = state_from(to_bytes(c), "state");
  EXPECT_EQ(again.clock.steps, 123);
  EXPECT_EQ(again.clock.longest, 1e-2);
  EXPECT_EQ(again.state.time, c.state.time);
  EXPECT_TRUE(again.state.has_previous);
  EXPECT_TRUE(again.state.x == c.state.x && again.state.v == c.state.v &&
              again.state.x_prev == c.state.x_prev);
  EXPECT_TRUE(again.state.v_prev == c.state.v_prev && again.state.last == c.state.last);
  EXPECT_TRUE(again.contacts == c.contacts);
  EXPECT_EQ(again.solver_memory, c.solver_memory);
  EXPECT_TRUE(again.surface_contact == c.surface_contact);
  EXPECT_EQ(again.gravity, c.gravity);
  EXPECT_TRUE(again.wind == c.wind && again.materials == c.materials && again.solids == c.solids);
  ASSERT_EQ(again.pins.size(), 1u);
  EXPECT_FALSE(again.pins[0].held);
  EXPECT_EQ(again.pins[0].to, c.pins[0].to);
  EXPECT_TRUE(again.solid_targets == c.solid_targets);
  EXPECT_EQ(again.deformations[0].to, c.deformations[0].to);
  EXPECT_EQ(again.shape_targets, c.shape_targets);
  EXPECT_EQ(to_bytes(again), to_bytes(c)) << "to the last bit, the sign of zero too";
}

TEST(Checkpoint, EmptyListsComeBackEmpty) {
  const Checkpoint again = parse_checkpoint(bytes_of(Checkpoint{}), "state.bin");
  EXPECT_TRUE(again.scene.empty() && again.files.empty() && again.snapshot.bytes.empty());
  const SimulationState none = state_from(to_bytes(SimulationState{}), "state");
  EXPECT_TRUE(none.state.x.empty() && none.pins.empty() && none.solids.empty());
}

TEST(Checkpoint, AnyTruncationIsRefused) {
  const std::string bytes = bytes_of(sample());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const std::string text = refusal(bytes.substr(0, length));
    ASSERT_TRUE(text.starts_with("run/checkpoint/state.bin: is damaged"))
        << length << " bytes: " << text;
  }
  EXPECT_NE(refusal(bytes + "x"), "not refused");
}

TEST(Checkpoint, AnyFlippedBitIsRefused) {
  const std::string bytes = bytes_of(sample());
  for (std::size_t place = 0; place < bytes.size(); ++place)
    for (const int bit : {0, 3, 7}) {
      std::string damaged = bytes;
      damaged[place] = static_cast<char>(damaged[place] ^ (1 << bit));
      ASSERT_NE(refusal(damaged), "not refused") << "byte " << place << ", bit " << bit;
    }
}

// A count that promises more than the file holds must not be believed, even with a right checksum:
// that is how memory is exhausted.
TEST(Checkpoint, ImpossibleCountsAreRefused) {
  for (const std::uint64_t count : {std::uint64_t{1000}, std::uint64_t{1} << 40, ~std::uint64_t{0},
                                    ~std::uint64_t{0} / 24 + 2}) {
    std::string bytes = bytes_of(sample());
    // the length of the scene's text
    bytes.replace(8, 8, reinterpret_cast<const char*>(&count), 8);
    std::uint64_t hash = 0xcbf29ce484222325ull;  // FNV-1a, as the header says
    for (std::size_t i = 0; i + 8 < bytes.size(); ++i)
      hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3ull;
    bytes.replace(bytes.size() - 8, 8, reinterpret_cast<const char*>(&hash), 8);
    EXPECT_TRUE(refusal(bytes).starts_with("run/checkpoint/state.bin: is damaged")) << count;
  }
}

}  // namespace
}  // namespace taut
