#pragma once
// A mark on a file that a living process is writing it. The kernel takes the mark away
// when the process ends, however it ends, so it never goes stale as a file with a
// process number in it would.
//
// It is a lock of the open file (fcntl's F_OFD_SETLK where the system has it): advisory, others may
// read and write the file as before.

#include <cstdio>
#include <filesystem>

namespace taut {

// Marks the file until `file` is closed or the process ends. Where the file system knows no locks
// nothing happens.
void mark_as_being_written(std::FILE* file);

// Whether another open file, of this or another process, holds the mark. False
// when there is no such file.
bool is_being_written(const std::filesystem::path& path);
bool is_being_written(int descriptor);

}  // namespace taut
