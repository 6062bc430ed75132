#include "taut/io/npy_header.h"

#include <charconv>

#include "taut/base/error.h"
#include "taut/io/little_endian.h"
#include "taut/io/text_cursor.h"

namespace taut {

namespace {

constexpr std::string_view magic = "\x93NUMPY";

std::string tuple_text(const std::vector<std::int64_t>& shape) {
  std::string text = "(";
  for (std::size_t axis = 0; axis < shape.size(); ++axis)
    text += (axis ? ", " : "") + std::to_string(shape[axis]);
  return text + (shape.size() == 1 ? ",)" : ")");
}

std::uint32_t little_endian_number(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t k = bytes.size(); k-- > 0;)
    value = value << 8 | static_cast<unsigned char>(bytes[k]);
  return value;
}

class HeaderParser {
 public:
  HeaderParser(const std::string& file, std::string_view text) : file_(file), text_(text) {}

  NpyHeader parse() {
    NpyHeader header;
    expect('{');
    while (!accept('}')) {
      const std::string key = string();
      expect(':');
      if (key == "descr")
        header.type = string();
      else if (key == "fortran_order")
        header.fortran_order = truth();
      else if (key == "shape")
        header.shape = tuple();
      else
        fail("has an unknown key " + in_quotes(key));
      keys_ += 1;
      if (!accept(',')) {
        expect('}');
        break;
      }
    }
    if (keys_ != 3 || header.type.empty()) fail("must hold descr, fortran_order and shape");
    return header;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError({file_}, "the .npy header " + message + "; the header is " + in_quotes(text_));
  }

  bool accept(char c) {
    while (!text_.empty() && (text_[0] == ' ' || text_[0] == '\n')) text_.remove_prefix(1);
    if (text_.empty() || text_[0] != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail(std::string("lacks '") + c + "' before what follows");
  }

  std::string string() {
    const char mark = accept('"') ? '"' : '\'';
    if (mark == '\'') expect('\'');
    const std::size_t end = text_.find(mark);
    if (end == std::string_view::npos) fail("has a string without end");
    const std::string word(text_.substr(0, end));
    text_.remove_prefix(end + 1);
    return word;
  }

  bool truth() {
    accept(' ');
    for (const std::string_view word : {"True", "False"})
      if (text_.substr(0, word.size()) == word) {
        text_.remove_prefix(word.size());
        return word == "True";
      }
    fail("has a fortran_order that is neither True nor False");
  }

  std::vector<std::int64_t> tuple() {
    std::vector<std::int64_t> numbers;
    expect('(');
    while (!accept(')')) {
      std::int64_t number = 0;
      const auto [stop, error] = std::from_chars(text_.data(), text_.data() + text_.size(), number);
      if (error != std::errc{} || number < 0) fail("has a shape with something else than counts");
      numbers.push_back(number);
      text_.remove_prefix(static_cast<std::size_t>(stop - text_.data()));
      if (!accept(',')) {
        expect(')');
        break;
      }
    }
    return numbers;
  }

  const std::string& file_;
  std::string_view text_;
  int keys_ = 0;
};

}  // namespace

std::string npy_header_text(std::string_view type, const std::vector<std::int64_t>& shape) {
  std::string dictionary = "{'descr': '" + std::string(type) +
                           "', 'fortran_order': False, 'shape': " + tuple_text(shape) + ", }";
  constexpr std::size_t alignment = 64, prefix = magic.size() + 4;
  dictionary.append(alignment - (prefix + dictionary.size() + 1) % alignment, ' ');
  dictionary += '\n';
  std::string bytes(magic);
  bytes += {'\x01', '\x00'};
  append_little_endian(bytes, static_cast<std::uint16_t>(dictionary.size()));
  return bytes + dictionary;
}

NpyHeader parse_npy_header(const std::string& file, std::string_view bytes) {
  if (bytes.size() < 12 || bytes.substr(0, magic.size()) != magic)
    throw InputError(
        {file}, "is not a .npy file (it does not begin with \\x93NUMPY); save it with numpy.save");
  const int version = bytes[6];
  if (version < 1 || version > 3)
    throw InputError({file},
                     "has .npy version " + std::to_string(version) + ", 1 to 3 can be read");
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  const std::size_t begin = magic.size() + 2 + length_bytes;
  const std::size_t length = little_endian_number(bytes.substr(magic.size() + 2, length_bytes));
  if (length > bytes.size() - begin)
    throw InputError({file}, "ends within its .npy header; the file was cut short");
  NpyHeader header = HeaderParser(file, bytes.substr(begin, length)).parse();
  header.data_start = begin + length;
  return header;
}

}  // namespace taut
