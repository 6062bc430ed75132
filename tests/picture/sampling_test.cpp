#include "taut/picture/sampling.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace taut::detail {
namespace {

using Points = std::vector<std::array<float, 2>>;

// Every box of area 1/2^bits with dyadic sides holds exactly one of the 2^bits points.
void expect_net(const Points& points, int bits) {
  ASSERT_EQ(points.size(), std::size_t{1} << bits);
  for (int across = 0; across <= bits; ++across) {
    std::set<int> boxes;
    for (const auto& p : points) {
      ASSERT_TRUE(p[0] >= 0 && p[0] < 1 && p[1] >= 0 && p[1] < 1);
      boxes.insert(static_cast<int>(p[0] * static_cast<float>(1 << across)) << (bits - across) |
                   static_cast<int>(p[1] * static_cast<float>(1 << (bits - across))));
    }
    EXPECT_EQ(boxes.size(), points.size())
        << "boxes of 1/" << (1 << across) << " x 1/" << (1 << (bits - across));
  }
}

TEST(Sampling, PixelsAndSquaresOfPixelsAreNets) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    for (std::uint32_t size : {1U, 2U, 4U}) {
      Points points;
      for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x)
          for (std::uint32_t i = 0; i < 16; ++i)
            points.push_back(PixelSamples(640 + x, 360 + y, 16, seed).at(i));
      expect_net(points, 4 + 2 * (size / 2));
    }
  }
}

TEST(Sampling, PixelsAndUsesDiffer) {
  std::set<std::array<float, 2>> seen;
  for (std::uint32_t y = 0; y < 32; ++y)
    for (std::uint32_t x = 0; x < 32; ++x)
      for (const std::uint32_t seed : {1U, 2U, 3U}) seen.insert(PixelSamples(x, y, 8, seed).at(0));
  EXPECT_GT(seen.size(), 3060U);  // of 3072
}

}  // namespace
}  // namespace taut::detail
