#include "taut/picture/cairo_canvas.h"

#include <fmt/format.h>

#include "taut/base/error.h"

namespace taut::detail {

namespace {

cairo_status_t append(void* closure, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

void check_cairo(cairo_status_t status, const char* what) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw InputError(fmt::format("{}: {}", what, cairo_status_to_string(status)));
}

CairoSurface make_canvas(int width, int height) {
  CairoSurface canvas(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  if (cairo_surface_status(canvas.get()) != CAIRO_STATUS_SUCCESS)
    throw InputError(
        fmt::format("a picture of {} x {} pixels cannot be made: {}; at most 32767 pixels a side, "
                    "and memory for it",
                    width, height, cairo_status_to_string(cairo_surface_status(canvas.get()))));
  return canvas;
}

CairoSurface to_cairo(const Image& image) {
  CairoSurface surface = make_canvas(image.width, image.height);
  cairo_surface_flush(surface.get());
  unsigned char* data = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int y = 0; y < image.height; ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * stride);
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.pixel(x, y);
      row[x] = std::uint32_t{p[0]} << 16 | std::uint32_t{p[1]} << 8 | std::uint32_t{p[2]};
    }
  }
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

std::string encode_png(cairo_surface_t* surface) {
  std::string bytes;
  check_cairo(cairo_surface_write_to_png_stream(surface, append, &bytes), "PNG encoding");
  return bytes;
}

}  // namespace taut::detail
