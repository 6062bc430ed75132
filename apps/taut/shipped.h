#pragma once
// Where the files are that come with the program: beside it where it is installed, else in the
// sources that it was built from.

#include <filesystem>

namespace taut::app {

std::filesystem::path share_folder();   // PREFIX/share/taut for PREFIX/bin/taut
std::filesystem::path source_folder();  // of the sources
// Of ball.toml and the other scenes that the benches run.
std::filesystem::path scenes_folder();

}  // namespace taut::app
