// Positions over time: what is written is read, and what belongs to another mesh is refused with
// the file's name.

#include "taut/io/motion_file.h"

#include <gtest/gtest.h>

#include <cstring>

#include "io/temporary_folder.h"
#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/io/obj.h"
#include "taut/io/pc2.h"
#include "test_data.h"

namespace taut {
namespace {

const std::vector<std::vector<Vec3>> samples{{{0, 1, 2}, {3, 4, 5}, {-0.5, 0.25, 8}},
                                             {{1, 1, 2}, {3, 4, 6}, {-0.5, 0.25, 9}}};

std::string refusal(const std::filesystem::path& path, Index vertices) {
  try {
    read_motion(path, vertices);
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(MotionFile, ReadsWhatPc2WriterWrites) {
  const test::TemporaryFolder folder;
  Pc2Writer writer(folder / "a.pc2", 3);
  for (const auto& sample : samples) writer.add_sample(sample);
  writer.finish();
  EXPECT_EQ(read_motion(folder / "a.pc2", 3), samples);
  EXPECT_NE(refusal(folder / "a.pc2", 4).find("a.pc2: has 3 points, the mesh has 4 vertices"),
            std::string::npos);
  const std::string bytes = read_file(folder / "a.pc2");
  write_file(folder / "cut.pc2", bytes.substr(0, bytes.size() - 4));
  EXPECT_NE(refusal(folder / "cut.pc2", 3).find("cut off"), std::string::npos);
}

TEST(MotionFile, ReadsRawFloats) {
  const test::TemporaryFolder folder;
  std::string bytes;
  for (const auto& sample : samples)
    for (const Vec3& x : sample)
      for (const double c : x) {
        const float value = static_cast<float>(c);
        bytes.append(reinterpret_cast<const char*>(&value), 4);
      }
  write_file(folder / "a.f32", bytes);
  EXPECT_EQ(read_motion(folder / "a.f32", 3), samples);
  EXPECT_NE(refusal(folder / "a.f32", 5).find("a.f32: has 72 bytes; a multiple of 60"),
            std::string::npos);
  bytes.replace(0, 4, "\xff\xff\xff\xff", 4);
  write_file(folder / "nan.f32", bytes);
  EXPECT_NE(refusal(folder / "nan.f32", 3).find("vertex 1 of sample 1 is not finite"),
            std::string::npos);
}

TEST(MotionFile, ReadsObjSequencesUntilTheyEnd) {
  const test::TemporaryFolder folder;
  for (int k = 0; k < 2; ++k)
    write_obj(folder / ("pose" + std::to_string(k + 9) + ".obj"), {samples[k], {{0, 1, 2}}, {}});
  write_obj(folder / "pose10.obj", {samples[1], {{0, 1, 2}}, {}});
  write_obj(folder / "pose12.obj", {samples[0], {{0, 1, 2}}, {}});
  EXPECT_EQ(read_motion(folder / "pose9.obj", 3), samples);
  write_obj(folder / "pose.obj", {samples[0], {{0, 1, 2}}, {}});
  EXPECT_NE(refusal(folder / "pose.obj", 3).find("has no number"), std::string::npos);
  EXPECT_NE(refusal(folder / "pose.abc", 3).find("unknown kind"), std::string::npos);
}

TEST(MotionFile, ReadsABodyThatRaisesItsArms) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "no ../shared/data and no $TAUT_DATA";
  const TriangleMesh mesh = read_obj(*data / "body/body_rest_tri.obj");
  const auto poses = read_motion(*data / "body/body_A_to_T_9x13380x3.f32",
                                 static_cast<Index>(mesh.positions.size()));
  ASSERT_EQ(poses.size(), 9u);
  double farthest = 0.0;
  for (std::size_t k = 1; k < poses.size(); ++k)
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      farthest = std::max(farthest, (poses[k][i] - poses[k - 1][i]).norm());
  EXPECT_GT(farthest, 0.02);
  EXPECT_LT(farthest, 0.06);
}

}  // namespace
}  // namespace taut
