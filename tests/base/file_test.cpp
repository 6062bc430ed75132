#include "taut/base/file.h"

#include <gtest/gtest.h>

#include <ostream>

#include "io/temporary_folder.h"
#include "taut/base/error.h"

namespace taut::test {
namespace {

namespace fs = std::filesystem;

template <class Action>
std::string input_error(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

bool names(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos;
}

TEST(WriteFile, KeepsEveryByteAndMakesTheFolder) {
  const TemporaryFolder folder;
  const std::string bytes("a\r\n\0\xff\n", 6);
  write_file(folder / "new/er/file.bin", bytes);
  EXPECT_EQ(read_file(folder / "new/er/file.bin"), bytes);
  write_file(folder / "empty", "");
  EXPECT_EQ(read_file(folder / "empty"), "");
}

TEST(WriteFile, ReplacesTheOldFileWhole) {
  const TemporaryFolder folder;
  const fs::path path = folder.file("f", "a long old content");
  write_file(path, "new");
  EXPECT_EQ(read_file(path), "new");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(WriteFile, OldFileStandsUntilTheNewOneIsComplete) {
  const TemporaryFolder folder;
  const fs::path path = folder.file("f", "old");
  write_file(path, [&](std::ostream& out) {
    out << "half" << std::flush;
    EXPECT_EQ(read_file(path), "old");
    out << " and half";
  });
  EXPECT_EQ(read_file(path), "half and half");
}

TEST(WriteFile, WriterThatThrowsLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  const fs::path path = folder.file("f", "old");
  const auto writer = [](std::ostream& out) {
    out << "half";
    throw std::length_error("stopped");
  };
  EXPECT_THROW(write_file(path, writer), std::length_error);
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(WriteFile, FailedStreamIsReportedAndLeavesTheOldFile) {
  const TemporaryFolder folder;
  const fs::path path = folder.file("f", "old");
  const std::string message = input_error([&] {
    write_file(path, [](std::ostream& out) { out << "half", out.setstate(std::ios::badbit); });
  });
  EXPECT_TRUE(names(message, path.string() + ": cannot be written")) << message;
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(WriteFile, TargetThatIsAFolderIsRefused) {
  const TemporaryFolder folder;
  write_file(folder / "target/inside", "x");
  const std::string message = input_error([&] { write_file(folder / "target", "y"); });
  EXPECT_TRUE(names(message, (folder / "target").string() + ": cannot be written")) << message;
  EXPECT_EQ(folder.entries(), 1u);
  EXPECT_EQ(read_file(folder / "target/inside"), "x");
}

TEST(WriteFile, FolderThatIsAFileIsRefused) {
  const TemporaryFolder folder;
  folder.file("f", "old");
  const std::string message = input_error([&] { write_file(folder / "f/g", "y"); });
  EXPECT_TRUE(names(message, "cannot be written") && names(message, "ot a directory")) << message;
  EXPECT_EQ(read_file(folder / "f"), "old");
}

TEST(ReadFile, NamesWhatItCannotRead) {
  const TemporaryFolder folder;
  const std::string missing = input_error([&] { read_file(folder / "none"); });
  EXPECT_TRUE(names(missing, (folder / "none").string()) && names(missing, "there is no such file"))
      << missing;
  folder.file("scene.toml", "");
  const std::string misspelt = input_error([&] { read_file(folder / "scen.toml"); });
  EXPECT_TRUE(names(misspelt, "did you mean '" + (folder / "scene.toml").string() + "'"))
      << misspelt;
  const std::string nowhere = input_error([&] { read_file(folder / "no/scene.toml"); });
  EXPECT_TRUE(names(nowhere, "there is no folder '" + (folder / "no").string() + "'")) << nowhere;
  const std::string is_folder = input_error([&] { read_file(folder / ""); });
  EXPECT_TRUE(names(is_folder, "it is a folder")) << is_folder;
}

}  // namespace
}  // namespace taut::test
