#include "taut/io/npy.h"

#include <cassert>
#include <cstring>
#include <limits>
#include <ostream>
#include <type_traits>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/io/little_endian.h"
#include "taut/io/npy_header.h"

namespace taut {

namespace {

template <class T>
constexpr const char* type_name() {
  if constexpr (std::is_same_v<T, float>) return "<f4";
  if constexpr (std::is_same_v<T, double>) return "<f8";
  if constexpr (std::is_same_v<T, std::int32_t>) return "<i4";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "|u1";
}

std::string shape_text(const std::vector<std::int64_t>& shape) {
  std::string text;
  for (const std::int64_t length : shape)
    text += (text.empty() ? "" : " x ") + std::to_string(length);
  return text.empty() ? "a single number" : text;
}

// Number of values, or -1 when it is beyond `most`.
std::int64_t value_count(const std::vector<std::int64_t>& shape, std::int64_t most) {
  for (const std::int64_t length : shape)
    if (length == 0) return 0;
  std::int64_t count = 1;
  for (const std::int64_t length : shape) {
    if (length > most / count) return -1;
    count *= length;
  }
  return count;
}

NpyHeader checked_header(const std::string& file, const std::string& bytes, const char* type) {
  NpyHeader header = parse_npy_header(file, bytes);
  if (header.type != type)
    throw InputError({file}, "holds numbers of type '" + header.type + "', '" + type +
                                 "' was expected; convert with numpy.astype and save again");
  if (header.fortran_order && header.shape.size() > 1)
    throw InputError({file},
                     "is in Fortran order, C order was expected; save numpy.ascontiguousarray(a)");
  return header;
}

template <class T>
NpyArray<T> array_of(const std::string& file, const std::string& bytes) {
  NpyHeader header = checked_header(file, bytes, type_name<T>());
  const std::size_t available = bytes.size() - header.data_start;
  const std::int64_t count = value_count(header.shape, static_cast<std::int64_t>(available));
  if (count < 0 || static_cast<std::size_t>(count) * sizeof(T) != available)
    throw InputError({file}, "has " + std::to_string(available) + " bytes of data, which is not " +
                                 shape_text(header.shape) + " numbers of " +
                                 std::to_string(sizeof(T)) +
                                 " bytes; the file was cut short or written wrongly");
  NpyArray<T> array{std::move(header.shape), std::vector<T>(static_cast<std::size_t>(count))};
  if (available > 0) std::memcpy(array.values.data(), bytes.data() + header.data_start, available);
  swap_if_big_endian(reinterpret_cast<char*>(array.values.data()), sizeof(T), array.values.size());
  return array;
}

template <class T>
std::vector<Vec3> nodes_of(const std::string& file, const NpyArray<T>& array) {
  if (array.shape.size() != 2 || array.shape[1] != 3)
    throw InputError(
        {file}, "has shape " + shape_text(array.shape) + ", n x 3 was expected (one row a node)");
  std::vector<Vec3> nodes(array.values.size() / 3);
  for (std::size_t k = 0; k < array.values.size(); ++k)
    nodes[k / 3][static_cast<int>(k % 3)] = array.values[k];
  return nodes;
}

}  // namespace

template <class T>
void write_npy(const std::filesystem::path& path, std::span<const std::int64_t> shape,
               const std::function<std::span<const T>()>& next) {
  const std::vector<std::int64_t> axes(shape.begin(), shape.end());
  write_file(path, [&](std::ostream& out) {
    out << npy_header_text(type_name<T>(), axes);
    std::int64_t missing = value_count(axes, std::numeric_limits<std::int64_t>::max());
    while (missing > 0) {
      const std::span<const T> values = next();
      assert(!values.empty() && std::ssize(values) <= missing);
      std::string piece(reinterpret_cast<const char*>(values.data()), values.size_bytes());
      swap_if_big_endian(piece.data(), sizeof(T), values.size());
      out.write(piece.data(), static_cast<std::streamsize>(piece.size()));
      missing -= std::ssize(values);
    }
  });
}

template <class T>
void write_npy(const std::filesystem::path& path, std::span<const T> values,
               std::span<const std::int64_t> shape) {
  assert(value_count({shape.begin(), shape.end()}, std::ssize(values)) == std::ssize(values));
  write_npy<T>(path, shape, [&] { return values; });
}

template <class T>
NpyArray<T> read_npy(const std::filesystem::path& path) {
  return array_of<T>(path.string(), read_file(path));
}

template void write_npy(const std::filesystem::path&, std::span<const float>,
                        std::span<const std::int64_t>);
template void write_npy(const std::filesystem::path&, std::span<const double>,
                        std::span<const std::int64_t>);
template void write_npy(const std::filesystem::path&, std::span<const std::int32_t>,
                        std::span<const std::int64_t>);
template void write_npy(const std::filesystem::path&, std::span<const std::uint8_t>,
                        std::span<const std::int64_t>);
template void write_npy(const std::filesystem::path&, std::span<const std::int64_t>,
                        const std::function<std::span<const float>()>&);
template NpyArray<float> read_npy(const std::filesystem::path&);
template NpyArray<double> read_npy(const std::filesystem::path&);
template NpyArray<std::int32_t> read_npy(const std::filesystem::path&);
template NpyArray<std::uint8_t> read_npy(const std::filesystem::path&);

void write_npy(const std::filesystem::path& path, std::span<const Vec3> nodes) {
  const std::int64_t shape[2] = {static_cast<std::int64_t>(nodes.size()), 3};
  write_npy<double>(path, flat(nodes), shape);
}

void write_npy_float(const std::filesystem::path& path, std::span<const Vec3> nodes) {
  const std::int64_t shape[2] = {static_cast<std::int64_t>(nodes.size()), 3};
  const std::span<const double> numbers = flat(nodes);
  const std::vector<float> rounded(numbers.begin(), numbers.end());
  write_npy<float>(path, rounded, shape);
}

std::vector<Vec3> read_npy_nodes(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  const std::string file = path.string();
  if (parse_npy_header(file, bytes).type == type_name<float>())
    return nodes_of(file, array_of<float>(file, bytes));
  return nodes_of(file, array_of<double>(file, bytes));
}

}  // namespace taut
