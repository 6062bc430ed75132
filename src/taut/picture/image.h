#pragma once
// A picture in memory.
//
//   rgb   3 * width * height bytes: red, green, blue of the pixels row by row from the top left,
//         sRGB encoded

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace taut {

struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
  const std::uint8_t* pixel(int x, int y) const {
    return rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                             static_cast<std::size_t>(x));
  }
};

// Throws InputError when width or height is not positive, or rgb has not 3 * width * height bytes;
// `what` names the image in the message.
void check_image(const Image& image, const char* what);

// Writes a PNG file, whole or not at all. Throws InputError for a bad image (check_image) or a path
// that cannot be written.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace taut
