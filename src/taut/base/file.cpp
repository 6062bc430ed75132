#include "taut/base/file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <vector>

#include "taut/base/error.h"

namespace taut {

namespace fs = std::filesystem;

namespace {
std::string system_reason() { return errno ? std::strerror(errno) : "unknown reason"; }

// What to do about a file that is not there.
std::string missing_file_advice(const fs::path& path) {
  constexpr std::size_t most_names = 10'000;
  std::error_code failure;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const std::string from = path.is_absolute() ? std::string()
                                              : fmt::format("; paths are taken from {}",
                                                            fs::current_path(failure).string());
  if (!fs::is_directory(folder, failure))
    return fmt::format("; there is no folder '{}' either{}", folder.string(), from);
  std::vector<std::string> names;
  for (fs::directory_iterator entry(folder, failure), end;
       !failure && entry != end && names.size() < most_names; entry.increment(failure))
    names.push_back(entry->path().filename().string());
  std::ranges::sort(names);
  const std::string near = nearest_name(path.filename().string(), names);
  return near.empty() ? "; check its name" + from
                      : fmt::format("; did you mean '{}'?", (path.parent_path() / near).string());
}
}  // namespace

void write_file(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  std::error_code failure, ignored;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), failure);
  // The process id keeps two programs that write into one folder from sharing a temporary file.
  const fs::path temporary = path.string() + ".tmp" + std::to_string(::getpid());
  if (failure && !fs::is_directory(path.parent_path(), ignored))
    throw InputError({path.string()}, "cannot be written: its folder cannot be made: " +
                                          failure.message() + "; check the permissions above it");
  errno = 0;
  bool complete = false;
  std::string reason;
  try {
    std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
    if (stream) {
      write(stream);
      stream.flush();
    }
    complete = static_cast<bool>(stream);
    if (!complete) reason = system_reason();
  } catch (...) {
    fs::remove(temporary, failure);
    throw;
  }
  if (complete) {
    fs::rename(temporary, path, failure);
    if (!failure) return;
    reason = failure.message();
  }
  fs::remove(temporary, failure);
  throw InputError({path.string()}, "cannot be written: " + reason +
                                        "; check the folder's permissions and free space");
}

void write_file(const fs::path& path, std::string_view content) {
  write_file(path, [&](std::ostream& out) {
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
  });
}

std::string read_file(const fs::path& path) {
  std::error_code failure;
  if (fs::is_directory(path, failure))
    throw InputError({path.string()}, "cannot be read: it is a folder, a file was expected");
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream && errno == ENOENT)
    throw InputError({path.string()}, "there is no such file" + missing_file_advice(path));
  if (!stream) throw InputError({path.string()}, "cannot be read: " + system_reason());
  std::ostringstream content;
  content << stream.rdbuf();
  return std::move(content).str();
}

}  // namespace taut
