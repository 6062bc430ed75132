#include "taut/base/file_lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

namespace taut {
namespace {

class FileLock : public testing::Test {
 protected:
  FileLock() { std::ofstream(path_) << "a row\n"; }
  ~FileLock() override { std::filesystem::remove(path_); }
  const std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("taut_file_lock_" + std::to_string(::getpid()));
};

TEST_F(FileLock, LastsAsLongAsTheFileIsOpen) {
  EXPECT_FALSE(is_being_written(path_));
  std::FILE* file = std::fopen(path_.c_str(), "ab");
  ASSERT_TRUE(file);
  EXPECT_FALSE(is_being_written(path_));
  mark_as_being_written(file);
  EXPECT_TRUE(is_being_written(path_));
  // looking, and closing what one looked with, takes nothing away
  EXPECT_TRUE(is_being_written(path_));
  std::fclose(file);
  EXPECT_FALSE(is_being_written(path_));
  EXPECT_FALSE(is_being_written(path_.string() + ".absent"));
}

TEST_F(FileLock, EndsWithAProcessThatIsKilled) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    mark_as_being_written(std::fopen(path_.c_str(), "ab"));
    (void)!::write(ready[1], "x", 1);
    for (;;) ::pause();
  }
  char byte;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_TRUE(is_being_written(path_));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_FALSE(is_being_written(path_));
  ::close(ready[0]), ::close(ready[1]);
}

}  // namespace
}  // namespace taut
