#pragma once
// Scene files (TOML): reading, writing, and advice about what was read. Every key, its unit, range
// and default: docs/scene-reference.md, which scene_reference() generates from the same
// declarations (scene/schema.h) that the reader checks against.
//
// Reading is strict. An unknown key, a wrong type, a number out of range, a missing key or file,
// two keys that exclude each other, broken TOML: each is reported with file, line and column, what
// was found, what was expected and what to do. None of these functions may change a scene behind
// the user's back: what is not in the file has the documented default.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "taut/scene/scene.h"

namespace taut {

// Reads `path` after changing it by `settings`, each "key=value" as after --set on the command
// line:
//   time.step=2e-3              a key by its dotted path; tables that are not there are made
//   cloth.k_stretch=6000        all [[cloth]] entries;       cloth.0.k_stretch=6000   the first one
//   cloth.grid.nodes=[41,41]    any TOML value;              solver.name=mpcg         a text needs
//   no quotes
// Throws InputError with one line for each of the first 20 errors, in the order of the file.
Scene read_scene(const std::filesystem::path& path, std::span<const std::string> settings = {});
// The same from text; `path` stands in messages, and relative paths start in its folder.
Scene read_scene_text(const std::string& text, const std::filesystem::path& path,
                      std::span<const std::string> settings = {});

// The whole scene with every default filled in, a comment beside each key. Reading it back from any
// folder gives the same scene to the last bit (but for Scene::folder): paths are absolute.
std::string scene_to_toml(const Scene& scene);

// docs/scene-reference.md.
std::string scene_reference();

// What is allowed but likely to disappoint: one sentence each, saying what to change. Empty when
// nothing stands out.
std::vector<std::string> doubtful(const Scene& scene);

}  // namespace taut
