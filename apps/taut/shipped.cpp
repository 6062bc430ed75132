#include "shipped.h"

namespace taut::app {

namespace fs = std::filesystem;

fs::path share_folder() {
  std::error_code failure;
  const fs::path program = fs::read_symlink("/proc/self/exe", failure);
  return program.parent_path().parent_path() / "share/taut";
}

fs::path source_folder() { return TAUT_SOURCES; }

fs::path scenes_folder() {
  std::error_code failure;
  const fs::path installed = share_folder() / "scenes";
  return fs::exists(installed / "ball.toml", failure) ? installed : source_folder() / "scenes";
}

}  // namespace taut::app
