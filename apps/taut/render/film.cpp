#include "render/film.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>
#include <vector>

#include "taut/base/error.h"
#include "taut/base/file.h"

extern "C" char** environ;

namespace taut::app {

namespace fs = std::filesystem;

namespace {

// Even sizes and 4:2:0 colours are what players read; bt709 is how they turn them back.
const std::vector<std::string> encoding{"-vf",
                                        "scale=trunc(iw/2)*2:trunc(ih/2)*2:out_color_matrix=bt709",
                                        "-c:v",
                                        "libx264",
                                        "-pix_fmt",
                                        "yuv420p",
                                        "-colorspace",
                                        "bt709",
                                        "-color_trc",
                                        "bt709",
                                        "-color_primaries",
                                        "bt709",
                                        "-crf",
                                        "17",
                                        "-preset",
                                        "medium",
                                        "-movflags",
                                        "+faststart"};

class Mp4Writer : public FilmWriter {
 public:
  Mp4Writer(fs::path path, double rate)
      : path_(std::move(path)),
        unfinished_(path_.string() + ".tmp" + std::to_string(::getpid()) + ".mp4"),
        said_(unfinished_.string() + ".log"),
        rate_(rate) {
    std::error_code failure;
    if (path_.has_parent_path()) fs::create_directories(path_.parent_path(), failure);
  }
  ~Mp4Writer() override {
    if (pipe_ >= 0) ::close(pipe_);
    if (child_ > 0) ::waitpid(child_, nullptr, 0);
    std::error_code failure;
    fs::remove(unfinished_, failure);
    fs::remove(said_, failure);
  }

  void add(const Image& picture) override {
    if (child_ < 0) start(picture.width, picture.height);
    for (std::size_t done = 0; done < picture.rgb.size();) {
      const ssize_t written = ::write(pipe_, picture.rgb.data() + done, picture.rgb.size() - done);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) fail();
      done += static_cast<std::size_t>(written);
    }
    ++pictures_;
  }

  std::string finish() override {
    if (!ended_well()) fail();
    std::error_code failure;
    fs::rename(unfinished_, path_, failure);
    if (failure)
      throw InputError({path_.string()}, "cannot be written: " + failure.message() +
                                             "; check the folder's permissions and free space");
    return fmt::format("{}: {} pictures, {:.1f} s", path_.string(), pictures_, pictures_ / rate_);
  }

 private:
  bool ended_well() {
    if (pipe_ >= 0) ::close(std::exchange(pipe_, -1));
    int state = 0;
    if (child_ > 0) ::waitpid(std::exchange(child_, -1), &state, 0);
    return WIFEXITED(state) && WEXITSTATUS(state) == 0;
  }

  [[noreturn]] void fail() {
    ended_well();
    std::string said = fs::exists(said_) ? read_file(said_) : std::string();
    while (!said.empty() && said.back() == '\n') said.pop_back();
    throw InputError({path_.string()}, "ffmpeg has failed: " + said +
                                           "\nUse --frames-only for a folder of PNG files");
  }

  void start(int width, int height) {
    // A write to an ffmpeg that has given up is an error to report, not a signal to die of.
    std::signal(SIGPIPE, SIG_IGN);
    std::vector<std::string> words{"ffmpeg",
                                   "-nostdin",
                                   "-loglevel",
                                   "error",
                                   "-y",
                                   "-f",
                                   "rawvideo",
                                   "-pix_fmt",
                                   "rgb24",
                                   "-s",
                                   fmt::format("{}x{}", width, height),
                                   "-r",
                                   fmt::format("{}", rate_),
                                   "-i",
                                   "pipe:0"};
    words.insert(words.end(), encoding.begin(), encoding.end());
    words.push_back(unfinished_.string());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0)
      throw InputError(std::string("ffmpeg cannot be started: ") + std::strerror(errno));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], 0);
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 2, said_.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0600);
    const int failure =
        ::posix_spawnp(&child_, "ffmpeg", &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[0]);
    pipe_ = ends[1];
    if (failure == 0) return;
    child_ = -1;
    throw InputError({path_.string()},
                     std::string("ffmpeg cannot be started: ") + std::strerror(failure));
  }

  fs::path path_, unfinished_, said_;
  double rate_;
  int pipe_ = -1, pictures_ = 0;
  pid_t child_ = -1;
};

bool is_picture_name(const std::string& name) {
  return name.size() == 10 && name.ends_with(".png") && name.find_first_not_of("0123456789") == 6;
}

// Those of an earlier film that was longer would become part of the new one.
void clear_pictures(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder))
    throw InputError({folder.string()},
                     "is a file; give a folder for the pictures with --out, or FILE.png");
  std::vector<fs::path> pictures;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!is_picture_name(entry.path().filename().string()))
      throw InputError(
          {folder.string()},
          fmt::format(
              "holds '{}', which is no picture of a film; give an empty or new folder with --out",
              entry.path().filename().string()));
    pictures.push_back(entry.path());
  }
  for (const fs::path& picture : pictures) fs::remove(picture);
}

class PngWriter : public FilmWriter {
 public:
  PngWriter(fs::path folder, double rate, fs::path film)
      : folder_(std::move(folder)), rate_(rate), film_(std::move(film)) {
    clear_pictures(folder_);
  }
  void add(const Image& picture) override {
    write_png(folder_ / fmt::format("{:06}.png", pictures_++), picture);
  }
  std::string finish() override {
    std::string command =
        fmt::format("ffmpeg -r {} -i '{}'", rate_, (folder_ / "%06d.png").string());
    for (const std::string& word : encoding)
      command += word.find('(') == std::string::npos ? " " + word : " '" + word + "'";
    return fmt::format("{} pictures in {}; this makes a film of them:\n{} '{}'", pictures_,
                       folder_.string(), command, film_.string());
  }

 private:
  fs::path folder_;
  double rate_;
  fs::path film_;
  int pictures_ = 0;
};

}  // namespace

bool has_ffmpeg() {
  pid_t child = -1;
  const char* arguments[] = {"ffmpeg", "-version", nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {0, 1, 2})
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  const int failure =
      ::posix_spawnp(&child, "ffmpeg", &actions, nullptr, const_cast<char**>(arguments), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) return false;
  int state = 0;
  ::waitpid(child, &state, 0);
  return WIFEXITED(state) && WEXITSTATUS(state) == 0;
}

std::unique_ptr<FilmWriter> make_mp4_writer(const fs::path& path, double rate) {
  return std::make_unique<Mp4Writer>(path, rate);
}
std::unique_ptr<FilmWriter> make_png_writer(const fs::path& folder, double rate,
                                            const fs::path& film) {
  return std::make_unique<PngWriter>(folder, rate, film);
}

}  // namespace taut::app
