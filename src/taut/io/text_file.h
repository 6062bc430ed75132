#pragma once
// Text files of any origin, as bytes that a parser can walk through (io/text_cursor.h).

#include <filesystem>
#include <string>

namespace taut {

// The whole text file, unpacked when it is gzip (recognised by its first two bytes), without a
// UTF-8 byte order mark. Throws InputError when it cannot be read, does not unpack, is UTF-16 or
// UTF-32, or holds a zero byte (so it is not text).
std::string read_text_file(const std::filesystem::path& path);

// The whole file as bytes, unpacked when it is gzip. Throws InputError when it cannot be read or
// does not unpack.
std::string read_unpacked_file(const std::filesystem::path& path);

}  // namespace taut
