#pragma once
// Numbers as little-endian bytes, the order of .npy, .pc2, .ply and .glb files, on any machine;
// big-endian for .mdd files.

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

namespace taut {

// In place: from or to the machine's order.
inline void swap_if_big_endian(char* bytes, std::size_t item_size, std::size_t count) {
  if constexpr (std::endian::native == std::endian::big)
    for (std::size_t k = 0; k < count; ++k)
      std::reverse(bytes + k * item_size, bytes + (k + 1) * item_size);
}

template <class T>
void append_little_endian(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  swap_if_big_endian(raw, sizeof(T), 1);
  bytes.append(raw, sizeof(T));
}

template <class T>
void append_big_endian(std::string& bytes, T value) {
  append_little_endian(bytes, value);
  std::reverse(bytes.end() - sizeof(T), bytes.end());
}

// The value whose bytes begin at `bytes`.
template <class T>
T read_little_endian(const char* bytes) {
  char raw[sizeof(T)];
  std::memcpy(raw, bytes, sizeof(T));
  swap_if_big_endian(raw, sizeof(T), 1);
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

}  // namespace taut
