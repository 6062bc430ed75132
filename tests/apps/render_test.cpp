// taut render: which files it makes, and what without ffmpeg. What is in the pictures:
// tests/results/frame_picture_test.cpp.

#include <gtest/gtest.h>

#include <cstdlib>

#include "program.h"

namespace taut::test {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

// "WxH" of a PNG file, from its first chunk.
std::string png_size(const fs::path& path) {
  const std::string bytes = read_text(path);
  if (bytes.size() < 24 || bytes.substr(1, 3) != "PNG") return "no PNG";
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t k = 0; k < 4; ++k)
      value = value * 256 + static_cast<unsigned char>(bytes[at + k]);
    return std::to_string(value);
  };
  return number(16) + "x" + number(20);
}

bool has_ffmpeg() { return std::system("ffmpeg -version > /dev/null 2>&1") == 0; }

class Render : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.file("small.toml", small_scene());
    ASSERT_EQ(
        taut(folder_, {"run", "small.toml", "--out", "r", "--quiet", "--no-picture"}).exit_code, 0);
  }
  ProgramEnd render(Names more) const {
    more.insert(more.begin(), {"render", "r"});
    more.insert(more.end(), {"--samples", "2"});
    return taut(folder_, more);
  }
  WorkFolder folder_;
};

TEST_F(Render, StillsAndSheets) {
  const ProgramEnd still = render({"--out", "pictures/still.png"});
  ASSERT_EQ(still.exit_code, 0) << still.err;
  EXPECT_EQ(still.out, "pictures/still.png\n");
  EXPECT_EQ(png_size(folder_ / "pictures/still.png"), "1280x720");
  // The last frame is the default, and a still of it is the same each time.
  ASSERT_EQ(render({"--out", "last.png", "--frame", "6", "--size", "1280x720", "--threads", "1"})
                .exit_code,
            0);
  EXPECT_TRUE(read_text(folder_ / "last.png") == read_text(folder_ / "pictures/still.png"));
  ASSERT_EQ(render({"--out", "first.png", "--frame", "0", "--size", "64x48"}).exit_code, 0);
  EXPECT_EQ(png_size(folder_ / "first.png"), "64x48");
  ASSERT_EQ(render({"--out", "sheet.png", "--size", "64x48"}).exit_code, 0);
  ASSERT_EQ(
      render({"--out", "two.png", "--size", "64x48", "--sheet", "2", "--frames", "2:4"}).exit_code,
      0);
  const auto width = [](const std::string& size) { return std::stoi(size); };
  EXPECT_GE(width(png_size(folder_ / "sheet.png")), 3 * 64);
  EXPECT_GE(width(png_size(folder_ / "two.png")), 2 * 64);
  EXPECT_LT(width(png_size(folder_ / "two.png")), 3 * 64);
}

TEST_F(Render, RefusesWhatIsNotThere) {
  const ProgramEnd beyond = render({"--out", "a.png", "--frame", "7"});
  EXPECT_EQ(beyond.exit_code, 1);
  EXPECT_NE(beyond.err.find("has the frames 0 to 6; 7 was asked for"), std::string::npos)
      << beyond.err;
  EXPECT_EQ(taut(folder_, {"render", "nothing", "--out", "a.png"}).exit_code, 1);
  // The camera in its own target.
  EXPECT_EQ(render({"--out", "a.png", "--from", "1,1,1", "--at", "1,1,1"}).exit_code, 1);
  EXPECT_FALSE(fs::exists(folder_ / "a.png"));
}

TEST_F(Render, FilmOfTheRightLength) {
  if (!has_ffmpeg()) GTEST_SKIP() << "no ffmpeg";
  // Six frames of 15 ms, ten times slower: 0.9 s, 28 pictures at 30 a second (the first and the
  // last are seen too).
  const ProgramEnd film = render({"--out", "films/a.mp4", "--size", "64x48", "--speed", "0.1"});
  ASSERT_EQ(film.exit_code, 0) << film.err;
  EXPECT_EQ(film.out, "films/a.mp4: 28 pictures, 0.9 s\n");
  EXPECT_EQ(names_in(folder_ / "films"), Names{"a.mp4"});
  const std::string probe = "cd '" + folder_.path().string() +
                            "' && ffprobe -v error -count_frames -select_streams v -show_entries "
                            "stream=codec_name,width,height,nb_read_frames "
                            "-of csv=p=0 films/a.mp4 > probed";
  ASSERT_EQ(std::system(probe.c_str()), 0);
  EXPECT_EQ(read_text(folder_ / "probed"), "h264,64,48,28\n");
}

TEST_F(Render, AFilmThatCannotBeWrittenIsSaid) {
  if (!has_ffmpeg()) GTEST_SKIP() << "no ffmpeg";
  folder_.file("file", "");
  const ProgramEnd end = render({"--out", "file/a.mp4", "--size", "64x48"});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_NE(end.err.find("file/a.mp4"), std::string::npos) << end.err;
}

TEST_F(Render, PicturesAndTheCommandWithoutFfmpeg) {
  const char* old = std::getenv("PATH");
  const std::string path = old ? old : "";
  ::setenv("PATH", (folder_ / "empty").c_str(), 1);
  const ProgramEnd end =
      render({"--out", "a film.mp4", "--size", "65x48", "--fps", "20", "--frames", "0:4"});
  ::setenv("PATH", path.c_str(), 1);
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_NE(end.err.find("there is no ffmpeg here"), std::string::npos) << end.err;
  EXPECT_EQ(names_in(folder_ / "a film_frames"), (Names{"000000.png", "000001.png"}));
  EXPECT_EQ(png_size(folder_ / "a film_frames/000001.png"), "65x48");
  const Names said = lines_of(end.out);
  ASSERT_EQ(said.size(), 2u) << end.out;
  EXPECT_EQ(said[1].substr(0, 12), "ffmpeg -r 20");
  if (!has_ffmpeg()) GTEST_SKIP() << "no ffmpeg: the command is not tried";
  EXPECT_EQ(
      std::system(("cd '" + folder_.path().string() + "' && " + said[1] + " 2> /dev/null").c_str()),
      0);
  EXPECT_GT(fs::file_size(folder_ / "a film.mp4"), 500u);
}

}  // namespace
}  // namespace taut::test
