#include <fmt/format.h>

#include <array>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/scene/scene_file.h"
#include "taut/scene/scene_settings.h"
#include "taut/scene/schema.h"
#include "taut/scene/schema_catalogue.h"
#include "taut/scene/toml_reader.h"

namespace taut {

namespace fs = std::filesystem;

namespace {

toml::table parse(const std::string& text, const std::string& path) {
  try {
    return toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    throw InputError(located(error.source(), "this is " + syntax_problem(error)));
  }
}

// Where else this key exists: "it belongs in [time]", "write [[cloth.pin]]"; "" when nowhere.
std::string home_of(const std::string& key) {
  std::string homes;
  for (const CatalogueTable& table : schema_catalogue()) {
    if (table.path == key || table.path.ends_with("." + key)) return "write " + table.heading();
    for (const CatalogueKey& known : table.keys) {
      if (known.name != key) continue;
      if (table.path.empty()) return "it belongs at the top of the file, before the first [table]";
      homes += (homes.empty() ? "it belongs in " : " or ") + table.heading();
    }
  }
  return homes;
}

Scene read(const toml::table& document, const fs::path& path) {
  Scene scene;
  scene.folder = fs::absolute(path).lexically_normal().parent_path();
  Complaints complaints;
  TomlReader reader(document, scene.folder, home_of, complaints);
  describe(reader, scene);
  reader.finish();
  complaints.throw_if_any();
  static_cast<std::map<std::string, SourcePlace>&>(scene.places) = reader.places();
  return scene;
}

}  // namespace

Scene read_scene_text(const std::string& text, const fs::path& path,
                      std::span<const std::string> settings) {
  toml::table document = parse(text, path.string());
  for (const std::string& setting : settings) apply_setting(document, setting);
  return read(document, path);
}

Scene read_scene(const fs::path& path, std::span<const std::string> settings) {
  return read_scene_text(read_file(path), path, settings);
}

}  // namespace taut
