#include "taut/picture/cairo_canvas.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cstdint>

#include "taut/base/error.h"

namespace taut::detail {

namespace {

std::string big_endian(std::uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift);
  return bytes;
}

// Of a PNG file: "The chunk layout", W3C PNG specification, section 5.3.
std::string chunk(const std::string& type, const std::string& data) {
  const std::string checked = type + data;
  const uLong sum = crc32_z(0, reinterpret_cast<const Bytef*>(checked.data()), checked.size());
  return big_endian(static_cast<std::uint32_t>(data.size())) + checked +
         big_endian(static_cast<std::uint32_t>(sum));
}

std::string compressed(const std::string& bytes) {
  constexpr int level = 3;
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string result(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(result.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()),
                level) != Z_OK)
    throw InputError("PNG encoding: not enough memory");
  result.resize(size);
  return result;
}

// Rows from the top: a byte that says "as they are", then red, green, blue. Neighbours'
// differences, which PNG also knows, compress worse where rays leave a grain.
std::string png_rows(cairo_surface_t* surface) {
  const int width = cairo_image_surface_get_width(surface),
            height = cairo_image_surface_get_height(surface),
            stride = cairo_image_surface_get_stride(surface);
  const unsigned char* data = cairo_image_surface_get_data(surface);
  std::string rows;
  rows.reserve((3 * static_cast<std::size_t>(width) + 1) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    const auto* row =
        reinterpret_cast<const std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * stride);
    rows += '\0';
    for (int x = 0; x < width; ++x)
      for (const int shift : {16, 8, 0}) rows += static_cast<char>(row[x] >> shift);
  }
  return rows;
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
  cairo_surface_flush(surface);
  const auto width = static_cast<std::uint32_t>(cairo_image_surface_get_width(surface)),
             height = static_cast<std::uint32_t>(cairo_image_surface_get_height(surface));
  const std::string kind("\x08\x02\0\0\0", 5);  // 8 bits of red, green, blue; not interlaced
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", big_endian(width) + big_endian(height) + kind) +
         chunk("IDAT", compressed(png_rows(surface))) + chunk("IEND", "");
}

}  // namespace taut::detail
