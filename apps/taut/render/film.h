#pragma once
// A film from pictures: MP4 (H.264) by ffmpeg in a process of its own; or, where ffmpeg is not
// installed, a folder of PNG files.

#include <filesystem>
#include <memory>
#include <string>

#include "taut/picture/image.h"

namespace taut::app {

bool has_ffmpeg();

class FilmWriter {
 public:
  virtual ~FilmWriter() = default;
  // Pictures of one size. Throws InputError when it cannot be written.
  virtual void add(const Image& picture) = 0;
  // What has been made, for the user. The film appears under its name here, whole.
  virtual std::string finish() = 0;
};

// A film PATH.mp4.
std::unique_ptr<FilmWriter> make_mp4_writer(const std::filesystem::path& path,
                                            double frames_per_second);
// FOLDER/000000.png, ...; pictures of that kind in it are replaced. Throws InputError when anything
// else is in it; finish() returns the command that makes the film `film` of them.
std::unique_ptr<FilmWriter> make_png_writer(const std::filesystem::path& folder,
                                            double frames_per_second,
                                            const std::filesystem::path& film);

}  // namespace taut::app
