#pragma once
// FNV-1a, 64 bits: h <- (h xor byte) * 0x100000001b3, from h = 0xcbf29ce484222325. Tells a damaged
// or changed file from the one that was written; no protection against somebody who wants two files
// to have the same sum.
//
// Source: Fowler, Noll, Vo, "The FNV Non-Cryptographic Hash Algorithm" (RFC 9923).

#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

namespace taut {

class Checksum {
 public:
  void add(std::string_view bytes) {
    for (const char c : bytes) value_ = (value_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  }
  // The bytes in memory of items without padding.
  template <class T>
  void add_items(std::span<const T> items) {
    static_assert(std::is_standard_layout_v<T>);
    add({reinterpret_cast<const char*>(items.data()), items.size_bytes()});
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ull;
};

}  // namespace taut
