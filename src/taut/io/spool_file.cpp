#include "taut/io/spool_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ostream>
#include <string>
#include <system_error>

#include "taut/base/error.h"

namespace taut {

void SpoolFile::fail() const {
  const std::string reason = errno ? std::strerror(errno) : "unknown reason";
  throw InputError({folder_.string()}, "cannot be written: " + reason +
                                           "; check the folder's permissions and free space");
}

namespace {

// A file without a name, which nothing is left of however the program ends; where the file system
// has no such thing, one whose name is gone at once.
int open_nameless(const std::filesystem::path& folder) {
#ifdef O_TMPFILE
  if (const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
      descriptor >= 0)
    return descriptor;
#endif
  std::string name = (folder / ".spool-XXXXXX").string();
  const int descriptor = ::mkstemp(name.data());
  if (descriptor >= 0) ::unlink(name.c_str());
  return descriptor;
}

}  // namespace

SpoolFile::SpoolFile(const std::filesystem::path& folder) : folder_(folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  errno = 0;
  const int descriptor = open_nameless(folder);
  if (descriptor < 0) fail();
  file_ = ::fdopen(descriptor, "w+b");
  if (!file_) {
    ::close(descriptor);
    fail();
  }
}

SpoolFile::~SpoolFile() { std::fclose(file_); }

void SpoolFile::append(std::string_view bytes) {
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail();
  size_ += bytes.size();
}

void SpoolFile::copy_to(std::ostream& out) {
  errno = 0;
  if (std::fflush(file_) != 0 || std::fseek(file_, 0, SEEK_SET) != 0) fail();
  char piece[1 << 16];
  for (std::size_t count; (count = std::fread(piece, 1, sizeof piece, file_)) > 0;)
    out.write(piece, static_cast<std::streamsize>(count));
  if (std::ferror(file_) || std::fseek(file_, 0, SEEK_END) != 0) fail();
}

}  // namespace taut
