#include "taut/base/file_lock.h"

#include <fcntl.h>
#include <unistd.h>

namespace taut {

namespace {

#ifdef F_OFD_SETLK
constexpr int set_lock = F_OFD_SETLK, get_lock = F_OFD_GETLK;
#else
constexpr int set_lock = F_SETLK, get_lock = F_GETLK;
#endif

// The whole file; l_pid must be 0.
struct flock whole_file(short type) {
  struct flock lock{};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  return lock;
}

}  // namespace

void mark_as_being_written(std::FILE* file) {
  struct flock lock = whole_file(F_WRLCK);
  (void)::fcntl(::fileno(file), set_lock, &lock);
}

bool is_being_written(int descriptor) {
  struct flock lock = whole_file(F_RDLCK);
  return ::fcntl(descriptor, get_lock, &lock) == 0 && lock.l_type != F_UNLCK;
}

bool is_being_written(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return false;
  const bool written = is_being_written(descriptor);
  ::close(descriptor);
  return written;
}

}  // namespace taut
