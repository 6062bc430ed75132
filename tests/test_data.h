#pragma once
// The third-party data that some tests read: $TAUT_DATA, or ../shared/data beside the repository.
// Absent: the test is skipped.

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace taut::test {

inline std::optional<std::filesystem::path> data_folder() {
  const char* chosen = std::getenv("TAUT_DATA");
  const std::filesystem::path folder =
      chosen ? std::filesystem::path(chosen)
             : std::filesystem::path(TAUT_SOURCE_DIR) / "../shared/data";
  std::error_code failure;
  if (!std::filesystem::is_directory(folder, failure)) return std::nullopt;
  return folder;
}

}  // namespace taut::test
