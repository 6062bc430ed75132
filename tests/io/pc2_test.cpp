#include "taut/io/pc2.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>

#include "io/temporary_folder.h"
#include "taut/base/error.h"

namespace taut::test {
namespace {

// Bytes to a number by arithmetic, independent of the writer's way.
std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;)
    value = value * 256 + static_cast<unsigned char>(bytes.at(at + k));
  return value;
}

TEST(Pc2Writer, HeaderAndSamplesAreWhereReadersLook) {
  const TemporaryFolder folder;
  Pc2Writer writer(folder / "cloth.pc2", 2, 1.0f, 0.5f);
  writer.add_sample(std::vector<Vec3>{{1, -2, 0.5}, {0.1, 0, 0}});
  EXPECT_FALSE(std::filesystem::exists(folder / "cloth.pc2"));
  writer.add_sample(std::vector<Vec3>{{0, 0, 0}, {0, 0, 6.5}});
  writer.add_sample(std::vector<Vec3>{{0, 0, 0}, {0, 0, 0}});
  writer.finish();
  EXPECT_EQ(writer.samples(), 3);
  EXPECT_EQ(folder.entries(), 1u);
  const std::string bytes = read_file(folder / "cloth.pc2");
  ASSERT_EQ(bytes.size(), 32u + 3 * 2 * 3 * 4);
  EXPECT_EQ(bytes.substr(0, 12), std::string("POINTCACHE2\0", 12));
  EXPECT_EQ(word(bytes, 12), 1u);
  EXPECT_EQ(word(bytes, 16), 2u);
  EXPECT_EQ(word(bytes, 20), 0x3f800000u);  // 1.0
  EXPECT_EQ(word(bytes, 24), 0x3f000000u);  // 0.5
  EXPECT_EQ(word(bytes, 28), 3u);
  EXPECT_EQ(word(bytes, 32), 0x3f800000u);
  EXPECT_EQ(word(bytes, 36), 0xc0000000u);            // -2
  EXPECT_EQ(word(bytes, 44), 0x3dcccccdu);            // 0.1 rounded to nearest
  EXPECT_EQ(word(bytes, 32 + 24 + 20), 0x40d00000u);  // 6.5
}

TEST(Pc2Writer, WithoutFinishNothingIsLeft) {
  const TemporaryFolder folder;
  {
    Pc2Writer writer(folder / "cloth.pc2", 1);
    writer.add_sample(std::vector<Vec3>{{1, 2, 3}});
  }
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(Pc2Writer, APlaceThatCannotBeWrittenIsRefused) {
  const TemporaryFolder folder;
  folder.file("a file", "");
  try {
    Pc2Writer writer(folder / "a file/cloth.pc2", 1);
    FAIL() << "no InputError";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("cloth.pc2: cannot be written: Not a directory"),
              std::string::npos)
        << error.what();
  }
}

// A cache of two samples of one point, byte by byte from the format's description; `patch` replaces
// bytes from `at` on.
std::string cache_bytes(std::size_t at = 0, std::string_view patch = {}) {
  std::string bytes("POINTCACHE2\0\1\0\0\0\1\0\0\0\0\0\x80\x3f\0\0\0\x3f\2\0\0\0", 32);
  bytes += std::string("\0\0\x80\x3f\0\0\0\xc0\0\0\0\x3f\0\0\xd0\x40\0\0\0\0\xcd\xcc\xcc\x3d", 24);
  return bytes.replace(at, patch.size(), patch);
}

TEST(ReadPc2, ReadsEverySampleInOrder) {
  const TemporaryFolder folder;
  const PointCache cache = read_pc2(folder.file("a.pc2", cache_bytes()));
  EXPECT_EQ(cache.points, 1);
  EXPECT_EQ(cache.start_frame, 1.0);
  EXPECT_EQ(cache.sample_rate, 0.5);
  ASSERT_EQ(cache.samples(), 2);
  EXPECT_EQ(cache.sample(0)[0], Vec3(1, -2, 0.5));
  EXPECT_EQ(cache.sample(1)[0], Vec3(6.5, 0, 0.1F));
}

TEST(ReadPc2, RoundTrip) {
  const TemporaryFolder folder;
  Pc2Writer writer(folder / "cloth.pc2", 3, -4.0F, 2.0F);
  std::vector<Vec3> positions;
  for (int k = 0; k < 12; ++k) positions.emplace_back(k, 0.1F * static_cast<float>(k), -1e30F);
  for (std::size_t sample = 0; sample < 4; ++sample)
    writer.add_sample(std::span(positions).subspan(3 * sample, 3));
  writer.finish();
  const PointCache cache = read_pc2(folder / "cloth.pc2");
  EXPECT_EQ(cache.positions, positions);
  EXPECT_EQ(cache.start_frame, -4.0);
  EXPECT_EQ(cache.sample_rate, 2.0);
}

TEST(ReadPc2, RefusesWhatIsNoWholeCache) {
  const TemporaryFolder folder;
  const std::string whole = cache_bytes();
  const std::string nan("\0\0\xc0\x7f", 4), huge("\xff\xff\xff\x7f", 4), none(4, '\0'),
      minus("\xff\xff\xff\xff", 4);
  const std::vector<std::pair<std::string, std::string>> bad{
      {"", "is no PC2"},
      {whole.substr(0, 31), "is no PC2"},
      {cache_bytes(3, "x"), "is no PC2"},
      {cache_bytes(12, "\2"), "version 2"},
      {whole.substr(0, 55), "has 55 bytes, but 1 points in 2 samples take 56"},
      {whole + "x", "has 57 bytes"},
      {cache_bytes(16, none), "holds 0 points"},
      {cache_bytes(16, minus), "holds -1 points"},
      {cache_bytes(16, huge), "has 56 bytes, but 2147483647 points in 2"},
      {cache_bytes(28, none), "0 samples"},
      {cache_bytes(20, nan), "first frame"},
      {cache_bytes(24, none), "has 0 frames between samples"},
      {cache_bytes(24, nan), "frames between samples"},
      {cache_bytes(32 + 16, nan), "sample 1, point 0: a coordinate is not finite"}};
  for (const auto& [bytes, said] : bad) {
    const std::filesystem::path path = folder.file("bad.pc2", bytes);
    try {
      read_pc2(path);
      ADD_FAILURE() << "read: " << said;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).rfind(path.string() + ": ", 0), 0u) << error.what();
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace taut::test
