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
  for (std::size_t k = 4; k-- > 0;) value = value * 256 + static_cast<unsigned char>(bytes.at(at + k));
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
    EXPECT_NE(std::string(error.what()).find("cloth.pc2: cannot be written: Not a directory"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace taut::test
