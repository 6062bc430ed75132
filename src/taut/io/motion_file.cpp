#include "taut/io/motion_file.h"

#include <fmt/format.h>

#include <cctype>
#include <cstring>
#include <string_view>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/io/little_endian.h"
#include "taut/io/obj.h"
#include "taut/io/pc2.h"

namespace taut {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t pc2_header = 32, pc2_points = 16, pc2_samples = 28;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw InputError({path.string()}, what);
}

std::int32_t integer_at(const std::string& bytes, std::size_t place) {
  char raw[4];
  std::memcpy(raw, bytes.data() + place, 4);
  swap_if_big_endian(raw, 4, 1);
  std::int32_t value = 0;
  std::memcpy(&value, raw, 4);
  return value;
}

std::vector<std::vector<Vec3>> floats(const fs::path& path, std::string_view bytes,
                                      Index vertices) {
  const std::size_t sample_size = 12 * static_cast<std::size_t>(vertices);
  std::vector<std::vector<Vec3>> samples;
  for (std::size_t start = 0; start < bytes.size(); start += sample_size) {
    std::vector<float> values(3 * static_cast<std::size_t>(vertices));
    std::memcpy(values.data(), bytes.data() + start, sample_size);
    swap_if_big_endian(reinterpret_cast<char*>(values.data()), 4, values.size());
    std::vector<Vec3>& sample = samples.emplace_back();
    for (std::size_t k = 0; k < values.size(); k += 3) {
      sample.emplace_back(values[k], values[k + 1], values[k + 2]);
      if (!sample.back().allFinite())
        fail(path, fmt::format("vertex {} of sample {} is not finite", k / 3 + 1, samples.size()));
    }
  }
  return samples;
}

std::vector<std::vector<Vec3>> read_raw(const fs::path& path, Index vertices) {
  const std::string bytes = read_file(path);
  const std::size_t sample_size = 12 * static_cast<std::size_t>(vertices);
  if (bytes.empty() || bytes.size() % sample_size != 0)
    fail(path, fmt::format("has {} bytes; a multiple of {} (float32, x y z of {} vertices a "
                           "sample) was expected: it belongs to another mesh",
                           bytes.size(), sample_size, vertices));
  return floats(path, bytes, vertices);
}

std::vector<std::vector<Vec3>> read_pc2(const fs::path& path, Index vertices) {
  const std::string bytes = read_file(path);
  if (bytes.size() < pc2_header || !bytes.starts_with(pc2_magic))
    fail(path, "is no PC2 point cache: its header was expected first");
  const std::int32_t points = integer_at(bytes, pc2_points), count = integer_at(bytes, pc2_samples);
  if (points != vertices)
    fail(path, fmt::format("has {} points, the mesh has {} vertices: it belongs to another mesh",
                           points, vertices));
  const std::size_t size =
      12 * static_cast<std::size_t>(vertices) * static_cast<std::size_t>(std::max(count, 0));
  if (count < 1 || bytes.size() - pc2_header < size)
    fail(path, fmt::format("is cut off: {} samples were expected", count));
  return floats(path, std::string_view(bytes).substr(pc2_header, size), vertices);
}

std::vector<std::vector<Vec3>> read_obj_sequence(const fs::path& first, Index vertices) {
  const std::string stem = first.stem().string();
  std::size_t digits = 0;
  while (digits < stem.size() &&
         std::isdigit(static_cast<unsigned char>(stem[stem.size() - 1 - digits])))
    ++digits;
  if (digits == 0 || digits > 9)
    fail(first, "has no number before .obj; name the first file of a sequence, like pose0001.obj");
  const std::string name = stem.substr(0, stem.size() - digits);
  std::vector<std::vector<Vec3>> samples;
  for (int number = std::stoi(stem.substr(name.size()));; ++number) {
    const fs::path file = first.parent_path() / fmt::format("{}{:0{}}.obj", name, number, digits);
    if (!samples.empty() && !fs::exists(file)) return samples;
    samples.push_back(read_obj(file).positions);
    if (std::ssize(samples.back()) != vertices)
      fail(file, fmt::format("has {} vertices, the mesh has {}: it belongs to another mesh",
                             samples.back().size(), vertices));
  }
}

}  // namespace

std::vector<std::vector<Vec3>> read_motion(const fs::path& path, Index vertices) {
  const std::string extension = path.extension().string();
  if (extension == ".pc2") return read_pc2(path, vertices);
  if (extension == ".f32" || extension == ".raw") return read_raw(path, vertices);
  if (extension == ".obj") return read_obj_sequence(path, vertices);
  fail(path,
       "is of an unknown kind; .pc2, .f32, .raw or the first .obj of a sequence was expected");
}

}  // namespace taut
