#pragma once
// The header of a PLY file: which elements follow, with which properties. Only for io/ply.h.
//
// Source: G. Turk, "The PLY Polygon File Format", 1994; type names also as
// int8, uint8, ..., float64.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "taut/io/text_cursor.h"

namespace taut::detail {

enum class PlyEncoding { ascii, binary_little_endian, binary_big_endian };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

constexpr std::size_t size_of(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}
constexpr bool is_integer(PlyType type) { return type < PlyType::float32; }

struct PlyProperty {
  std::string name;
  PlyType type{};
  bool is_list = false;
  PlyType count_type{};  // of a list
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  int line = 0;
  std::vector<PlyProperty> properties;
  // Index of the first property of one of these names, or -1.
  int find(std::initializer_list<std::string_view> names) const;
};

struct PlyHeader {
  PlyEncoding encoding{};
  std::vector<PlyElement> elements;
  std::size_t size = 0;  // bytes, end_header with its line end included
};

// Throws InputError with line and column on anything that is no PLY header.
PlyHeader parse_ply_header(const std::string& file, std::string_view bytes);

}  // namespace taut::detail
