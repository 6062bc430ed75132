#include "taut/io/ply_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace taut::detail {

namespace {

class PlyText : public PlyData {
 public:
  PlyText(const std::string& file, std::string_view bytes, std::size_t begin)
      : cursor_(file, bytes, false) {
    while (bytes.size() - cursor_.bytes_left() < begin) cursor_.next_line();
  }

  double number(PlyType type) override {
    const std::string_view word = cursor_.word();
    if (word.empty())
      throw InputError(cursor_.place(), "a number is missing; the line ends too early");
    double value = 0;
    const NumberFault fault = parse_number(word, value);
    if (fault == NumberFault::not_a_number ||
        (is_integer(type) && fault == NumberFault::none && std::trunc(value) != value))
      throw InputError(cursor_.place(), "found " + in_quotes(word) +
                                            (is_integer(type) ? ", a whole number" : ", a number") +
                                            " was expected");
    if (fault == NumberFault::too_large)
      throw InputError(cursor_.place(), "found " + in_quotes(word) + ", which is too large");
    return value;
  }
  void begin_element() override {
    while (!cursor_.at_end() && cursor_.at_line_end()) cursor_.next_line();
    if (!cursor_.at_end()) return;
    cursor_.word();
    throw InputError(cursor_.place(),
                     "the file ends before all elements that its header names; it was cut short");
  }
  void end_element() override {
    if (!cursor_.at_line_end()) {
      const std::string_view word = cursor_.word();
      throw InputError(cursor_.place(),
                       "found " + in_quotes(word) + ", the end of the line was expected");
    }
    cursor_.next_line();
  }
  std::size_t most_left(PlyType) const override { return cursor_.bytes_left() / 2 + 1; }
  SourcePlace place() const override { return cursor_.place(); }

 private:
  TextCursor cursor_;
};

class PlyBytes : public PlyData {
 public:
  PlyBytes(std::string file, std::string_view bytes, std::size_t begin, bool big_endian)
      : file_(std::move(file)),
        bytes_(bytes),
        next_(begin),
        swap_(big_endian != (std::endian::native == std::endian::big)) {}

  double number(PlyType type) override {
    last_ = next_;
    if (bytes_.size() - next_ < size_of(type))
      throw InputError(
          {file_},
          fmt::format(
              "ends at byte {}, before all elements that its header names; it was cut short",
              bytes_.size()));
    char raw[8];
    std::memcpy(raw, bytes_.data() + next_, size_of(type));
    if (swap_) std::reverse(raw, raw + size_of(type));
    next_ += size_of(type);
    return value_of(type, raw);
  }
  std::size_t most_left(PlyType type) const override {
    return (bytes_.size() - next_) / size_of(type);
  }
  SourcePlace place() const override { return {file_}; }
  std::string place_in_words() const override { return fmt::format(" (byte {})", last_ + 1); }

 private:
  template <class T>
  static double as(const char* raw) {
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return static_cast<double>(value);
  }
  static double value_of(PlyType type, const char* raw) {
    switch (type) {
      case PlyType::int8:
        return as<std::int8_t>(raw);
      case PlyType::uint8:
        return as<std::uint8_t>(raw);
      case PlyType::int16:
        return as<std::int16_t>(raw);
      case PlyType::uint16:
        return as<std::uint16_t>(raw);
      case PlyType::int32:
        return as<std::int32_t>(raw);
      case PlyType::uint32:
        return as<std::uint32_t>(raw);
      case PlyType::float32:
        return as<float>(raw);
      case PlyType::float64:
        return as<double>(raw);
    }
    return 0;
  }

  std::string file_;
  std::string_view bytes_;
  std::size_t next_, last_ = 0;
  bool swap_;
};

}  // namespace

std::unique_ptr<PlyData> make_ply_data(const std::string& file, std::string_view bytes,
                                       const PlyHeader& header) {
  if (header.encoding == PlyEncoding::ascii)
    return std::make_unique<PlyText>(file, bytes, header.size);
  return std::make_unique<PlyBytes>(file, bytes, header.size,
                                    header.encoding == PlyEncoding::binary_big_endian);
}

}  // namespace taut::detail
