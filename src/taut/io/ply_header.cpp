#include "taut/io/ply_header.h"

#include <algorithm>
#include <array>
#include <utility>

#include "taut/base/error.h"

namespace taut::detail {

namespace {

constexpr std::array<std::pair<std::string_view, PlyType>, 16> type_names{
    {{"char", PlyType::int8},
     {"uchar", PlyType::uint8},
     {"short", PlyType::int16},
     {"ushort", PlyType::uint16},
     {"int", PlyType::int32},
     {"uint", PlyType::uint32},
     {"float", PlyType::float32},
     {"double", PlyType::float64},
     {"int8", PlyType::int8},
     {"uint8", PlyType::uint8},
     {"int16", PlyType::int16},
     {"uint16", PlyType::uint16},
     {"int32", PlyType::int32},
     {"uint32", PlyType::uint32},
     {"float32", PlyType::float32},
     {"float64", PlyType::float64}}};

class HeaderParser {
 public:
  HeaderParser(const std::string& file, std::string_view bytes)
      : bytes_(bytes), cursor_(file, bytes, false) {}

  PlyHeader parse() {
    if (!bytes_.starts_with("ply") || cursor_.word() != "ply" || !cursor_.at_line_end())
      throw InputError({cursor_.file(), 1}, "is no PLY file: a first line 'ply' was expected");
    while (next_line()) {
      const std::string_view keyword = cursor_.word();
      if (keyword == "end_header") return finish();
      read_line(keyword);
    }
    throw InputError(
        {cursor_.file(), cursor_.line_of_word()},
        "the header of this PLY file ends without 'end_header'; the file was cut short");
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(cursor_.place(), message);
  }

  bool next_line() {
    cursor_.next_line();
    return !cursor_.at_end();
  }

  void read_line(std::string_view keyword) {
    if (keyword == "comment" || keyword == "obj_info") return;
    if (keyword == "format")
      read_format();
    else if (keyword == "element")
      read_element();
    else if (keyword == "property")
      read_property();
    else
      fail("found " + in_quotes(keyword) +
           " in a PLY header; format, comment, obj_info, element, property or end_header was "
           "expected");
    if (!cursor_.at_line_end()) {
      const std::string_view word = cursor_.word();
      fail("found " + in_quotes(word) + ", the end of the line was expected");
    }
  }

  void read_format() {
    constexpr std::array<std::string_view, 3> names{"ascii", "binary_little_endian",
                                                    "binary_big_endian"};
    const std::string_view name = cursor_.word();
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
      fail("the format is " + in_quotes(name) +
           "; ascii, binary_little_endian or binary_big_endian was expected");
    header_.encoding = static_cast<PlyEncoding>(found - names.begin());
    const std::string_view version = cursor_.word();
    if (version != "1.0")
      fail("the format's version is " + in_quotes(version) + "; 1.0 was expected");
    has_format_ = true;
  }

  void read_element() {
    PlyElement element;
    element.name = cursor_.word();
    element.line = cursor_.line_of_word();
    if (element.name.empty()) fail("an element without a name");
    for (const PlyElement& other : header_.elements)
      if (other.name == element.name)
        fail("a second element " + in_quotes(element.name) + "; each was expected once");
    const std::string_view count = cursor_.word();
    if (parse_integer(count, element.count) != NumberFault::none || element.count < 0)
      fail("the number of elements is " + in_quotes(count) + ", a whole number was expected");
    header_.elements.push_back(std::move(element));
  }

  PlyType read_type() {
    const std::string_view word = cursor_.word();
    const auto* const found = std::find_if(type_names.begin(), type_names.end(),
                                           [&](const auto& entry) { return entry.first == word; });
    if (found == type_names.end())
      fail("the type is " + in_quotes(word) +
           "; char, uchar, short, ushort, int, uint, float or double was expected");
    return found->second;
  }

  void read_property() {
    if (header_.elements.empty()) fail("a property before the first element");
    PlyProperty property;
    TextCursor ahead = cursor_;
    property.is_list = ahead.word() == "list";
    if (property.is_list) {
      cursor_ = ahead;
      property.count_type = read_type();
      if (!is_integer(property.count_type))
        fail("the length of a list is a whole number, so its type cannot be float or double");
    }
    property.type = read_type();
    property.name = cursor_.word();
    if (property.name.empty()) fail("a property without a name");
    header_.elements.back().properties.push_back(std::move(property));
  }

  PlyHeader finish() {
    if (!has_format_) fail("the header has no 'format' line");
    // Binary data begin right after one line end, and may begin with the byte of another: header
    // lines ending in CR alone end there.
    const std::size_t before = bytes_.size() - cursor_.bytes_left();
    const bool carriage_returns = bytes_.size() > 4 && bytes_[3] == '\r' && bytes_[4] != '\n';
    cursor_.next_line();
    header_.size = carriage_returns ? std::min(before + 1, bytes_.size())
                                    : bytes_.size() - cursor_.bytes_left();
    return std::move(header_);
  }

  std::string_view bytes_;
  TextCursor cursor_;
  PlyHeader header_;
  bool has_format_ = false;
};

}  // namespace

int PlyElement::find(std::initializer_list<std::string_view> names) const {
  for (std::size_t p = 0; p < properties.size(); ++p)
    if (std::find(names.begin(), names.end(), properties[p].name) != names.end())
      return static_cast<int>(p);
  return -1;
}

PlyHeader parse_ply_header(const std::string& file, std::string_view bytes) {
  return HeaderParser(file, bytes).parse();
}

}  // namespace taut::detail
