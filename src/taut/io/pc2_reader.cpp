#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/io/little_endian.h"
#include "taut/io/pc2.h"

namespace taut {

namespace {

constexpr std::size_t header_size = 32;
constexpr std::size_t point_size = 3 * sizeof(float);

struct Header {
  std::int32_t points, samples;
  float start_frame, sample_rate;
};

Header checked_header(const std::string& file, const std::string& bytes) {
  if (bytes.size() < header_size || !std::string_view(bytes).starts_with(pc2_magic))
    throw InputError({file},
                     "is no PC2 point cache: the 32 bytes of its header, beginning with "
                     "POINTCACHE2, were expected");
  const char* at = bytes.data() + pc2_magic.size();
  const auto version = read_little_endian<std::int32_t>(at);
  if (version != 1)
    throw InputError(
        {file}, fmt::format("is a PC2 point cache of version {}, version 1 was expected", version));
  const Header header{read_little_endian<std::int32_t>(at + 4),
                      read_little_endian<std::int32_t>(at + 16), read_little_endian<float>(at + 8),
                      read_little_endian<float>(at + 12)};
  if (header.points < 1 || header.samples < 1)
    throw InputError({file}, fmt::format("says that it holds {} points and {} samples, at least "
                                         "one of each was expected; the program that "
                                         "wrote it may have been stopped",
                                         header.points, header.samples));
  if (!std::isfinite(header.start_frame))
    throw InputError({file}, "has a first frame that is not finite");
  if (!(header.sample_rate > 0.0F) || !std::isfinite(header.sample_rate))
    throw InputError({file},
                     fmt::format("has {} frames between samples, a positive number was expected",
                                 header.sample_rate));
  // Both counts are below 2^31, so that the product fits.
  const std::uint64_t expected = header_size + std::uint64_t{point_size} *
                                                   static_cast<std::uint64_t>(header.points) *
                                                   static_cast<std::uint64_t>(header.samples);
  if (bytes.size() != expected)
    throw InputError({file}, fmt::format("has {} bytes, but {} points in {} samples take {}; it "
                                         "was cut short or written wrongly",
                                         bytes.size(), header.points, header.samples, expected));
  return header;
}

}  // namespace

PointCache read_pc2(const std::filesystem::path& path) {
  const std::string file = path.string();
  const std::string bytes = read_file(path);
  const Header header = checked_header(file, bytes);
  PointCache cache{header.points, header.start_frame, header.sample_rate, {}};
  cache.positions.resize((bytes.size() - header_size) / point_size);
  const char* at = bytes.data() + header_size;
  for (std::size_t i = 0; i < cache.positions.size(); ++i, at += point_size) {
    Vec3& x = cache.positions[i];
    for (int c = 0; c < 3; ++c)
      x[c] = read_little_endian<float>(at + static_cast<std::size_t>(c) * sizeof(float));
    if (!x.allFinite())
      throw InputError({file}, fmt::format("sample {}, point {}: a coordinate is not finite; mend "
                                           "it in the program that wrote the file",
                                           i / static_cast<std::size_t>(header.points),
                                           i % static_cast<std::size_t>(header.points)));
  }
  return cache;
}

}  // namespace taut
