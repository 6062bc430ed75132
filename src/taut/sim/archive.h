#pragma once
// Values as bytes and back, little-endian, without names: for snapshots and checkpoints. A type
// that is stored has one transfer(archive, value), which both directions walk.

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "taut/base/error.h"
#include "taut/base/types.h"

namespace taut {

static_assert(std::endian::native == std::endian::little, "archives are little-endian");

class ArchiveWriter {
 public:
  static constexpr bool reads = false;
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&v), sizeof(T));
  }
  void value(const Vec3& v) {
    for (const double entry : v) value(entry);
  }
  // Of items without padding; a text too.
  template <class Container>
  void list(const Container& items) {
    value(static_cast<std::uint64_t>(items.size()));
    bytes_.append(reinterpret_cast<const char*>(items.data()),
                  items.size() * sizeof(typename Container::value_type));
  }
  // Of items that are transferred one by one.
  template <class Container, class Each>
  void each(const Container& items, Each&& transfer_item) {
    value(static_cast<std::uint64_t>(items.size()));
    for (const auto& item : items) transfer_item(*this, item);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class ArchiveReader {
 public:
  static constexpr bool reads = true;
  // `name` stands in messages. Throws InputError where the bytes do not fit what is read.
  ArchiveReader(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}
  template <class T>
  void value(T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    need(sizeof(T));
    std::memcpy(&v, bytes_.data(), sizeof(T));
    bytes_.remove_prefix(sizeof(T));
  }
  void value(Vec3& v) {
    for (double& entry : v) value(entry);
  }
  template <class Container>
  void list(Container& items) {
    constexpr std::size_t item = sizeof(typename Container::value_type);
    const std::size_t count = size(item);
    items.resize(count);
    if (count == 0) return;  // an empty list may have no memory, which memcpy must not be given
    std::memcpy(static_cast<void*>(items.data()), bytes_.data(), count * item);
    bytes_.remove_prefix(count * item);
  }
  template <class Container, class Each>
  void each(Container& items, Each&& transfer_item) {
    items.resize(size(1));
    for (auto& item : items) transfer_item(*this, item);
  }
  bool at_end() const { return bytes_.empty(); }
  [[noreturn]] void fail() const {
    throw InputError(
        {name_}, "is damaged or of another version of Taut; run the scene anew with `taut run`");
  }

 private:
  // An item takes at least so many bytes: no more are made room for than there can be.
  std::size_t size(std::size_t least) {
    std::uint64_t count = 0;
    value(count);
    if (count > bytes_.size() / least) fail();
    return static_cast<std::size_t>(count);
  }
  void need(std::size_t count) const {
    if (bytes_.size() < count) fail();
  }
  std::string_view bytes_;
  std::string name_;
};

}  // namespace taut
