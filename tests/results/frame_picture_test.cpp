// Pictures of a result: what must be seen is seen, nothing is black, nothing is clipped.
#include "taut/results/frame_picture.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "taut/base/error.h"
#include "taut/scene/scene_file.h"
#include "taut/sim/cloth_model.h"

namespace taut::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* scene_text = R"(title = "Picture"
[time]
step = 1e-2
frames = 4
[[cloth]]
name = "sheet"
grid = { nodes = [21, 21], origin = [-0.5, -0.5, 0.8], u = [1, 0, 0], v = [0, 1, 0] }
density = 0.15
k_stretch = 500
[[solid]]
shape = "sphere"
radius = 0.2
translation = [0.2, -0.75, 0.2]
[[solid]]
shape = "sphere"
radius = 0.1
translation = [-40, 0, 0.5]
velocity = [1000, 0, 0]
)";

// The scene's cloth at rest, with a wave in it, as the frames of a result.
class PictureOfAResult : public ::testing::Test {
 protected:
  PictureOfAResult()
      : results_(folder()),
        scene_(read_scene_text(scene_text, folder() / "scene.toml")),
        simulation_(scene_) {
    results_.start(simulation_);
    for (int frame = 0; frame <= 4; ++frame) {
      std::vector<Vec3> x = simulation_.cloth().start().x;
      for (Vec3& p : x) p.z() += 0.02 * frame * std::sin(12 * p.x()) - 0.02 * frame;
      results_.write_frame(frame, x);
    }
  }
  ~PictureOfAResult() override {
    std::error_code failure;
    fs::remove_all(folder(), failure);
  }
  static fs::path folder() {
    return fs::temp_directory_path() / ("taut_picture_" + std::to_string(::getpid()));
  }

  Image draw(int frame, PictureOptions options = {}) const {
    options.samples = 4;
    options.width = 160;
    options.height = 120;
    const std::vector<int> frames{0, 1, 2, 3, 4};
    return FramePictures(simulation_.scene(), simulation_.cloth(), results_, frames, options)
        .draw(frame);
  }

  ResultsFolder results_;
  Scene scene_;
  SceneSimulation simulation_;
};

double share(const Image& image, const std::function<bool(int r, int g, int b)>& holds) {
  int count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      count += holds(image.pixel(x, y)[0], image.pixel(x, y)[1], image.pixel(x, y)[2]);
  return static_cast<double>(count) / (image.width * image.height);
}

bool is_blue(int r, int, int b) { return b > r + 40; }
bool is_grey(int r, int g, int b) { return std::max({r, g, b}) - std::min({r, g, b}) < 24; }

TEST_F(PictureOfAResult, ClothBallAndGroundAreSeenWithoutBlackOrClipping) {
  const Image image = draw(4);
  EXPECT_GT(share(image, is_blue), 0.07);
  EXPECT_LT(share(image, is_blue), 0.8);
  EXPECT_EQ(share(image, [](int r, int g, int b) { return std::max({r, g, b}) < 12; }), 0.0)
      << "black";
  EXPECT_LT(share(image, [](int r, int g, int b) { return std::min({r, g, b}) >= 254; }), 0.002)
      << "clipped";
  // The ground's shadow: grey, and much darker than the ground around.
  EXPECT_GT(share(image, [](int r, int g, int b) { return is_grey(r, g, b) && g < 170; }), 0.02);
  PictureOptions without;
  without.ground = false;
  EXPECT_LT(
      share(draw(4, without), [](int r, int g, int b) { return is_grey(r, g, b) && g < 120; }),
      0.02);
}

// The far ball would make the cloth a dot.
TEST_F(PictureOfAResult, AMovingSolidDoesNotTakeTheCameraAway) {
  EXPECT_GT(share(draw(0), is_blue), 0.05);
}

// Without a plane the ground must hide no solid: a box too large to belong into the view, and a
// body whose feet end just below zero.
TEST_F(PictureOfAResult, TheGroundHidesNoSolid) {
  struct Case {
    const char* solid;
    double ground;
  };
  for (const auto& [solid, ground] :
       {Case{"translation = [0, 0, 0.4]\nsize = [3, 3, 0.8]\n", 0.0},
        Case{"translation = [0, 0, 0.3994]\nsize = [3, 3, 0.8]\n", -6e-4}}) {
    const std::string text = std::string(scene_text) + "[[solid]]\nshape = \"box\"\n" + solid;
    const Scene scene = read_scene_text(text, folder() / "scene.toml");
    const std::vector<int> frames{0, 4};
    const FramePictures pictures(scene, simulation_.cloth(), results_, frames, {});
    ASSERT_TRUE(pictures.ground().has_value());
    EXPECT_NEAR(*pictures.ground(), ground, 1e-12);
  }
}

TEST_F(PictureOfAResult, FoldsAreReadable) {
  // A wave makes light and shade: neighbouring cloth pixels span more brightness than on the flat
  // sheet.
  PictureOptions plain;
  plain.pattern = Pattern::none;
  const auto spread = [&](const Image& image) {
    std::vector<int> green;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const std::uint8_t* p = image.pixel(x, y);
        if (is_blue(p[0], p[1], p[2])) green.push_back(p[1]);
      }
    std::sort(green.begin(), green.end());
    return green[green.size() * 9 / 10] - green[green.size() / 10];
  };
  EXPECT_GT(spread(draw(4, plain)), spread(draw(0, plain)) + 20);
}

TEST_F(PictureOfAResult, PatternsAndCameraAreAsAsked) {
  PictureOptions plain, checker;
  plain.pattern = Pattern::none;
  checker.pattern = Pattern::checker;
  const auto mean_blue = [](const Image& image) {
    double sum = 0;
    for (std::size_t k = 2; k < image.rgb.size(); k += 3) sum += image.rgb[k];
    return sum;
  };
  EXPECT_LT(mean_blue(draw(0, checker)), mean_blue(draw(0)));
  EXPECT_LT(mean_blue(draw(0)), mean_blue(draw(0, plain)));
  // From below the sheet shows its other colour.
  PictureOptions below;
  below.ground = false;
  below.from = Vec3(0.1, -0.1, -2.0);
  EXPECT_EQ(share(draw(0, below), is_blue), 0.0);
  EXPECT_GT(share(draw(0, below), [](int r, int, int b) { return r > b + 40; }), 0.1);
  // Looking past everything.
  PictureOptions away;
  away.from = Vec3(0, 0, 5);
  away.at = Vec3(0, 0, 9);
  EXPECT_EQ(share(draw(0, away), is_blue), 0.0);
}

TEST_F(PictureOfAResult, AFrameOfAnotherSizeIsRefused) {
  results_.write_frame(2, std::vector<Vec3>(3, Vec3::Zero()));
  EXPECT_THROW(draw(2), InputError);
  EXPECT_THROW(draw(9), InputError);
}

TEST(SpreadFrames, FirstAndLastAreAmongThem) {
  EXPECT_EQ(spread_frames(80, 6), (std::vector<int>{0, 16, 32, 48, 64, 80}));
  EXPECT_EQ(spread_frames(2, 6), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(spread_frames(7, 1), std::vector<int>{7});
  EXPECT_EQ(spread_frames(2'000'000'000, 3), (std::vector<int>{0, 1'000'000'000, 2'000'000'000}));
}

}  // namespace
}  // namespace taut::test
