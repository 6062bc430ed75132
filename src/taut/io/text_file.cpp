#include "taut/io/text_file.h"

#include <zlib.h>

#include "taut/base/error.h"
#include "taut/base/file.h"

namespace taut {

namespace {

// A few bytes of gzip can claim terabytes; beyond this the file has to be unpacked by its owner.
constexpr std::size_t largest_unpacked = std::size_t{1} << 29;

bool starts_with(std::string_view bytes, std::string_view mark) {
  return bytes.substr(0, mark.size()) == mark;
}

class Unpacker {
 public:
  explicit Unpacker(const std::string& packed) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream_.avail_in = static_cast<uInt>(packed.size());
    ready_ = inflateInit2(&stream_, 16 + MAX_WBITS) == Z_OK;  // 16: the gzip frame
  }
  ~Unpacker() {
    if (ready_) inflateEnd(&stream_);
  }
  Unpacker(const Unpacker&) = delete;
  Unpacker& operator=(const Unpacker&) = delete;

  // Appends the next piece; Z_OK while there is more, Z_STREAM_END when all is unpacked.
  int unpack_some(std::string& text) {
    if (!ready_) return Z_MEM_ERROR;
    char piece[1 << 16];
    stream_.next_out = reinterpret_cast<Bytef*>(piece);
    stream_.avail_out = sizeof piece;
    const int result = inflate(&stream_, Z_NO_FLUSH);
    text.append(piece, sizeof piece - stream_.avail_out);
    // Several gzip members one after the other are one file.
    if (result == Z_STREAM_END && stream_.avail_in > 0) return inflateReset(&stream_);
    return result;
  }

 private:
  z_stream stream_{};
  bool ready_ = false;
};

std::string unpack(const std::string& file, const std::string& packed) {
  Unpacker unpacker(packed);
  std::string text;
  int result = Z_OK;
  while (result == Z_OK) {
    result = unpacker.unpack_some(text);
    if (text.size() > largest_unpacked)
      throw InputError({file},
                       "unpacks to more than 512 MiB; unpack it with gunzip and read that file");
  }
  if (result != Z_STREAM_END)
    throw InputError({file},
                     "is a gzip file that does not unpack (damaged or cut short); fetch it again");
  return text;
}

}  // namespace

std::string read_unpacked_file(const std::filesystem::path& path) {
  std::string bytes = read_file(path);
  return starts_with(bytes, "\x1f\x8b") ? unpack(path.string(), bytes) : bytes;
}

std::string read_text_file(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::string text = read_unpacked_file(path);
  if (starts_with(text, "\xfe\xff") || starts_with(text, "\xff\xfe") ||
      starts_with(text, std::string_view("\0\0\xfe\xff", 4)))
    throw InputError({file, 1},
                     "is UTF-16 or UTF-32 text, UTF-8 was expected; save it as UTF-8 (iconv -f "
                     "UTF-16 -t UTF-8)");
  const std::size_t zero = text.find('\0');
  if (zero != std::string::npos)
    throw InputError({file}, "is not a text file: byte " + std::to_string(zero + 1) +
                                 " is zero (binary data or UTF-16 text)");
  if (starts_with(text, "\xef\xbb\xbf")) text.erase(0, 3);
  return text;
}

}  // namespace taut
