#include "view/result_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "taut/base/error.h"

namespace taut::app {

namespace {

std::string reason() { return std::strerror(errno); }

OpenFile open_folder(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor >= 0) return {descriptor, path.string()};
  if (errno == ENOENT)
    throw InputError({path.string()},
                     "there is no such folder; give one that `taut run` writes or has written");
  if (errno == ENOTDIR)
    throw InputError({path.string()}, "is a file; give the folder that `taut run` has written");
  throw InputError({path.string()}, "cannot be opened: " + reason());
}

struct stat facts_of(const OpenFile& file) {
  struct stat facts{};
  if (::fstat(file.descriptor(), &facts) != 0)
    throw InputError({file.path()}, "cannot be examined: " + reason());
  return facts;
}

bool fits(const NpyHeader& header, std::string_view type, std::int64_t row) {
  if (header.type != type || header.fortran_order) return false;
  return row == 1 ? header.shape.size() == 1 : header.shape.size() == 2 && header.shape[1] == row;
}

}  // namespace

void OpenFile::close_and_delete(const int* descriptor) {
  ::close(*descriptor);
  delete descriptor;
}

std::size_t OpenFile::size() const { return static_cast<std::size_t>(facts_of(*this).st_size); }

std::string OpenFile::identity() const {
  const struct stat facts = facts_of(*this);
  return fmt::format("{:x}-{:x}", facts.st_ino,
                     facts.st_ctim.tv_sec * 1'000'000'000 + facts.st_ctim.tv_nsec);
}

std::string OpenFile::read(std::size_t offset, std::size_t length) const {
  std::string bytes(length, '\0');
  std::size_t done = 0;
  while (done < length) {
    const ssize_t n = ::pread(descriptor(), bytes.data() + done, length - done,
                              static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw InputError({path()}, "cannot be read: " + reason());
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  bytes.resize(done);
  return bytes;
}

ResultFiles::ResultFiles(const std::filesystem::path& folder)
    : path_(folder), folder_(open_folder(folder)) {}

std::string ResultFiles::frame_name(int frame) { return fmt::format("{:06}.npy", frame); }
std::string ResultFiles::contact_name(int frame) { return fmt::format("contact_{:06}.npy", frame); }

std::optional<OpenFile> ResultFiles::open_at(int folder, const std::string& name,
                                             const std::filesystem::path& shown) const {
  // O_NONBLOCK: a pipe of that name must not hold us up.
  const int descriptor =
      ::openat(folder, name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0 && errno == ENOENT) return std::nullopt;
  if (descriptor < 0 && errno == ELOOP)
    throw InputError({shown.string()},
                     "is a symbolic link; `taut view` follows none inside a results folder");
  if (descriptor < 0) throw InputError({shown.string()}, "cannot be opened: " + reason());
  OpenFile file(descriptor, shown.string());
  if (!S_ISREG(facts_of(file).st_mode)) throw InputError({shown.string()}, "is not a file");
  return file;
}

std::optional<OpenFile> ResultFiles::open(const std::string& name) const {
  return open_at(folder_.descriptor(), name, path_ / name);
}

std::optional<OpenFile> ResultFiles::open_in_frames(const std::string& name) const {
  const int descriptor =
      ::openat(folder_.descriptor(), "frames", O_RDONLY | O_NOFOLLOW | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0 && errno == ENOENT) return std::nullopt;
  const std::filesystem::path shown = path_ / "frames";
  if (descriptor < 0 && (errno == ELOOP || errno == ENOTDIR))
    throw InputError(
        {shown.string()},
        "is no folder, or a symbolic link; `taut view` follows none inside a results folder");
  if (descriptor < 0) throw InputError({shown.string()}, "cannot be opened: " + reason());
  const OpenFile frames(descriptor, shown.string());
  return open_at(descriptor, name, shown / name);
}

std::optional<ArrayFile> ResultFiles::open_array(const std::string& name, std::string_view type,
                                                 std::int64_t row) const {
  const auto file = open_in_frames(name);
  if (!file) return std::nullopt;
  ArrayFile array{*file, parse_npy_header(file->path(), file->read(0, 4096))};
  const NpyHeader& header = array.header;
  if (!fits(header, type, row))
    throw InputError({file->path()},
                     fmt::format("holds {} with {} axes; {} was expected, {} to a row", header.type,
                                 header.shape.size(), type, row));
  // Divided, not multiplied: a header may claim any number.
  const std::size_t row_bytes =
      static_cast<std::size_t>(type.back() - '0') * static_cast<std::size_t>(row);
  if (file->size() < header.data_start || array.bytes() % row_bytes != 0 ||
      array.bytes() / row_bytes != static_cast<std::size_t>(header.shape[0]))
    throw InputError({file->path()},
                     "has another size than its header says; the file was cut short or damaged");
  return array;
}

std::optional<ArrayFile> ResultFiles::open_frame(int frame) const {
  return open_array(frame_name(frame), "<f4", 3);
}
std::optional<ArrayFile> ResultFiles::open_contact(int frame) const {
  return open_array(contact_name(frame), "|u1", 1);
}

}  // namespace taut::app
