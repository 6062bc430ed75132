#include "view/page_files.h"

#include <cstdlib>
#include <vector>

#include "shipped.h"
#include "taut/base/error.h"
#include "taut/base/file.h"

namespace taut::app {

namespace fs = std::filesystem;

namespace {

std::string media_type(const fs::path& file) {
  static const std::map<std::string, std::string> types{{".html", "text/html; charset=utf-8"},
                                                        {".js", "text/javascript; charset=utf-8"},
                                                        {".css", "text/css; charset=utf-8"},
                                                        {".svg", "image/svg+xml"},
                                                        {".png", "image/png"},
                                                        {".woff2", "font/woff2"}};
  const auto known = types.find(file.extension().string());
  return known == types.end() ? "application/octet-stream" : known->second;
}

}  // namespace

fs::path page_folder() {
  if (const char* chosen = std::getenv("TAUT_VIEWER")) {
    if (fs::exists(fs::path(chosen) / "index.html")) return chosen;
    throw InputError({chosen},
                     "holds no index.html, but the environment variable TAUT_VIEWER names it as "
                     "the viewer's page");
  }
  std::error_code failure;
  for (const fs::path& folder : {share_folder() / "viewer", source_folder() / "build/viewer"})
    if (fs::exists(folder / "index.html", failure)) return folder;
  throw InputError(
      "the viewer's page has not been built; `./taut view DIR` in Taut's sources builds it (it "
      "needs Node.js 18 or newer and npm)");
}

PageFiles read_page(const fs::path& folder) {
  PageFiles files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[entry.path().lexically_relative(folder).generic_string()] = {read_file(entry.path()),
                                                                         media_type(entry.path())};
  return files;
}

}  // namespace taut::app
