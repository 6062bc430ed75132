#pragma once
// Files that are never seen half-written: everything goes to a temporary file beside the target,
// which is then renamed.

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace taut {

// Calls `write` with a binary stream on a temporary file in the target's folder (made if missing),
// flushes it and renames it to `path`. Throws InputError naming the path and the system's reason
// when anything fails (no permission, disk full); the old file then stays.
void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);
void write_file(const std::filesystem::path& path, std::string_view content);

// The whole file as bytes. Throws InputError("PATH: cannot be read: REASON") when it is a folder or
// not readable; of a missing one it says what may have been meant.
std::string read_file(const std::filesystem::path& path);

}  // namespace taut
