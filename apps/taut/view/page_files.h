#pragma once
// The built page of the viewer (viewer/, built by npm), held in memory: a request can only name
// what was there when the program started.

#include <filesystem>
#include <map>
#include <string>

namespace taut::app {

struct PageFile {
  std::string content, type;  // bytes; media type
};

// By path from the page's own folder, with slashes: "index.html", "assets/index-1a2b.js".
using PageFiles = std::map<std::string, PageFile>;

// $TAUT_VIEWER, share/taut/viewer beside an installed program, or build/viewer of the sources it
// was built from: the first that holds an index.html. Throws InputError when none does.
std::filesystem::path page_folder();
PageFiles read_page(const std::filesystem::path& folder);

}  // namespace taut::app
