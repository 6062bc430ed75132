#include "taut/picture/contact_sheet.h"

#include <cairo.h>
#include <gtest/gtest.h>

#include "taut/base/error.h"
#include "taut/base/file.h"

namespace taut {
namespace {

namespace fs = std::filesystem;

class ContactSheet : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("taut_contact_sheet_" +
               std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

// A PNG file as cairo reads it back.
class Decoded {
 public:
  explicit Decoded(const fs::path& path)
      : surface_(cairo_image_surface_create_from_png(path.c_str())) {}
  ~Decoded() { cairo_surface_destroy(surface_); }
  Decoded(const Decoded&) = delete;
  Decoded& operator=(const Decoded&) = delete;
  bool ok() const { return cairo_surface_status(surface_) == CAIRO_STATUS_SUCCESS; }
  int width() const { return cairo_image_surface_get_width(surface_); }
  int height() const { return cairo_image_surface_get_height(surface_); }
  std::uint32_t pixel(int x, int y) const {
    const unsigned char* row =
        cairo_image_surface_get_data(surface_) + y * cairo_image_surface_get_stride(surface_);
    return reinterpret_cast<const std::uint32_t*>(row)[x] & 0xffffffU;
  }

 private:
  cairo_surface_t* surface_;
};

Image plain(int width, int height, std::uint32_t colour) {
  Image image{width, height, {}};
  for (int i = 0; i < width * height; ++i)
    for (const int shift : {16, 8, 0})
      image.rgb.push_back(static_cast<std::uint8_t>(colour >> shift));
  return image;
}

// Where a colour stands in the sheet: its bounding box and number of pixels.
struct Patch {
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1, count = 0;
};
Patch find(const Decoded& sheet, std::uint32_t colour) {
  Patch p;
  for (int y = 0; y < sheet.height(); ++y)
    for (int x = 0; x < sheet.width(); ++x)
      if (sheet.pixel(x, y) == colour) {
        p.left = std::min(p.left, x);
        p.right = std::max(p.right, x);
        p.top = std::min(p.top, y);
        p.bottom = std::max(p.bottom, y);
        ++p.count;
      }
  return p;
}

int ink_between(const Decoded& sheet, int left, int right, int top, int bottom) {
  int count = 0;
  for (int y = std::max(0, top); y < std::min(bottom, sheet.height()); ++y)
    for (int x = std::max(0, left); x < std::min(right, sheet.width()); ++x)
      count += sheet.pixel(x, y) != 0xffffffU ? 1 : 0;
  return count;
}

TEST_F(ContactSheet, StillIsReadBackBitForBit) {
  Image image = plain(37, 23, 0);
  for (std::size_t i = 0; i < image.rgb.size(); ++i)
    image.rgb[i] = static_cast<std::uint8_t>(i * 7 + i / 50);
  write_png(folder_ / "still.png", image);
  const Decoded png(folder_ / "still.png");
  ASSERT_TRUE(png.ok());
  ASSERT_EQ(png.width(), 37);
  ASSERT_EQ(png.height(), 23);
  for (int y = 0; y < 23; ++y)
    for (int x = 0; x < 37; ++x) {
      const std::uint8_t* p = image.pixel(x, y);
      EXPECT_EQ(png.pixel(x, y),
                std::uint32_t{p[0]} << 16 | std::uint32_t{p[1]} << 8 | std::uint32_t{p[2]});
    }
}

TEST_F(ContactSheet, TilesStandWholeInRowsWithLabelsBelow) {
  const std::vector<std::uint32_t> colours{0xc01020, 0x10c020, 0x1020c0, 0xc0c010, 0x10c0c0};
  std::vector<Tile> tiles;
  for (const std::uint32_t c : colours) tiles.push_back({plain(240, 180, c), "t = 0.25 s"});
  write_contact_sheet(folder_ / "sheet.png", tiles, "Ball", 3);
  const Decoded sheet(folder_ / "sheet.png");
  ASSERT_TRUE(sheet.ok());
  std::vector<Patch> patches;
  for (const std::uint32_t c : colours) patches.push_back(find(sheet, c));
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const Patch& p = patches[i];
    EXPECT_EQ(p.count, 240 * 180);
    EXPECT_EQ(p.right - p.left + 1, 240);
    EXPECT_EQ(p.top, patches[i / 3 * 3].top);
    EXPECT_EQ(p.left, patches[i % 3].left);
    EXPECT_GT(ink_between(sheet, p.left, p.right, p.bottom + 1, p.bottom + 20), 30)
        << "label of tile " << i;
    EXPECT_EQ(ink_between(sheet, p.right + 1, p.right + 6, p.top, p.bottom), 0)
        << "gap right of tile " << i;
  }
  EXPECT_GT(patches[1].left, patches[0].right + 5);
  EXPECT_GT(patches[3].top, patches[0].bottom + 15);
  EXPECT_GT(ink_between(sheet, 0, sheet.width(), 0, patches[0].top), 50);  // the title
  EXPECT_EQ(ink_between(sheet, patches[2].left, sheet.width(), patches[4].top, sheet.height()), 0);
}

TEST_F(ContactSheet, LongTextIsShortenedInsideItsTile) {
  const std::string long_label =
      "Überlange Beschriftung: μ = 0.3, k = 6000 N/m, 25 921 Knoten und noch viel mehr Text als "
      "Platz ist";
  const std::vector<Tile> tiles{{plain(160, 90, 0xc01020), long_label},
                                {plain(160, 90, 0x10c020), ""}};
  write_contact_sheet(folder_ / "sheet.png", tiles, long_label + long_label, 2);
  const Decoded sheet(folder_ / "sheet.png");
  ASSERT_TRUE(sheet.ok());
  const Patch first = find(sheet, 0xc01020), second = find(sheet, 0x10c020);
  EXPECT_GT(ink_between(sheet, first.left, first.right, first.bottom + 1, sheet.height()), 100);
  EXPECT_EQ(ink_between(sheet, second.left, sheet.width(), second.bottom + 1, sheet.height()), 0);
  EXPECT_EQ(ink_between(sheet, sheet.width() - 8, sheet.width(), 0, sheet.height()), 0);
}

TEST_F(ContactSheet, TilesOfDifferentSizesAreCentred) {
  const std::vector<Tile> tiles{{plain(100, 80, 0xc01020), ""}, {plain(40, 20, 0x10c020), ""}};
  write_contact_sheet(folder_ / "sheet.png", tiles, "");
  const Decoded sheet(folder_ / "sheet.png");
  const Patch large = find(sheet, 0xc01020), small = find(sheet, 0x10c020);
  EXPECT_EQ(small.count, 800);
  EXPECT_EQ(small.top - large.top, 30);
  EXPECT_EQ(large.left + sheet.height() - 1 - large.bottom, 2 * large.left);  // equal margins
}

TEST_F(ContactSheet, ColumnsAreChosenForFewGaps) {
  const std::vector<std::pair<int, int>> expected{{1, 1}, {2, 2}, {3, 3},  {4, 2},  {5, 3}, {6, 3},
                                                  {8, 4}, {9, 3}, {12, 4}, {16, 4}, {20, 5}};
  for (const auto& [tiles, columns] : expected)
    EXPECT_EQ(contact_sheet_columns(tiles), columns) << tiles << " tiles";
}

TEST_F(ContactSheet, BadInputLeavesTheOldFile) {
  const fs::path path = folder_ / "sheet.png";
  write_file(path, std::string_view("old"));
  const Tile good{plain(10, 10, 0x10c020), ""};
  Tile truncated = good, empty = good, not_utf8 = good;
  truncated.image.rgb.pop_back();
  empty.image = Image{};
  not_utf8.label = "t = \xff\xfe";
  for (const Tile& bad : {truncated, empty, not_utf8}) {
    const std::vector<Tile> tiles{good, bad};
    EXPECT_THROW(write_contact_sheet(path, tiles, "title"), InputError);
  }
  EXPECT_THROW(write_contact_sheet(path, {}, "title"), InputError);
  const std::vector<Tile> wide(12, Tile{plain(3000, 1, 0), ""});
  EXPECT_THROW(write_contact_sheet(path, wide, "", 12), InputError);
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(ContactSheet, AFolderInTheWayIsNamed) {
  fs::create_directories(folder_ / "sheet.png" / "inside");
  const std::vector<Tile> tiles{{plain(10, 10, 0), ""}};
  try {
    write_contact_sheet(folder_ / "sheet.png", tiles, "");
    FAIL() << "expected InputError";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("sheet.png"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace taut
