#include "taut/picture/image.h"

#include <fmt/format.h>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/picture/cairo_canvas.h"

namespace taut {

void check_image(const Image& image, const char* what) {
  if (image.width <= 0 || image.height <= 0)
    throw InputError(fmt::format("{}: size {} x {}, expected at least 1 x 1 pixels", what,
                                 image.width, image.height));
  const std::size_t expected =
      3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.rgb.size() != expected)
    throw InputError(fmt::format("{}: {} bytes of colour, expected 3 * {} * {} = {}", what,
                                 image.rgb.size(), image.width, image.height, expected));
}

void write_png(const std::filesystem::path& path, const Image& image) {
  check_image(image, "image");
  write_file(path, detail::encode_png(detail::to_cairo(image).get()));
}

}  // namespace taut
