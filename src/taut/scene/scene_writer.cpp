#include <fmt/format.h>
#include <fmt/ranges.h>

#include "taut/scene/scene_file.h"
#include "taut/scene/schema.h"
#include "taut/scene/toml_values.h"

namespace taut {

namespace {

class TomlWriter final : public SchemaVisitor {
 public:
  std::string text() const { return levels_.front().keys + levels_.front().tables; }

  void number(const char* key, double& value, const KeyInfo& info) override {
    line(key, to_toml(value), info);
  }
  void integer(const char* key, int& value, const KeyInfo& info) override {
    line(key, std::to_string(value), info);
  }
  void flag(const char* key, bool& value, const KeyInfo& info) override {
    line(key, value ? "true" : "false", info);
  }
  void text(const char* key, std::string& value, const KeyInfo& info) override {
    line(key, to_toml(value), info);
  }
  void file(const char* key, std::filesystem::path& value, const KeyInfo& info) override {
    if (info.applies && !info.unset)
      line(key, to_toml(std::filesystem::absolute(value).lexically_normal().string()), info);
  }
  void vector(const char* key, Vec3& value, const KeyInfo& info) override {
    line(key, to_toml(value), info);
  }
  void rotation(const char* key, Eigen::Quaterniond& value, const KeyInfo& info) override {
    line(key, to_toml(value), info);
  }
  void integers(const char* key, std::vector<Index>& value, const KeyInfo& info) override {
    line(key, to_toml(value), info);
  }
  void choose(const char* key, int& value, std::span<const char* const> names,
              const KeyInfo& info) override {
    line(key, to_toml(std::string(names[static_cast<std::size_t>(value)])), info,
         fmt::format("one of {}; ", fmt::join(names, ", ")));
  }
  void choose_some(const char* key, std::vector<std::string>& value, std::span<const char* const>,
                   const KeyInfo& info) override {
    line(key, to_toml(value), info);
  }
  void table(const char* key, const KeyInfo& info, const std::function<void()>& inside) override {
    if (info.applies && !info.unset) below(key, "[", "]", inside);
  }
  bool given(const char*, bool now) override { return now; }
  void exactly_one(std::span<const char* const>) override {}
  void check(bool, const char*, const std::string&) override {}

 protected:
  void tables(const char* key, const TableList& items, const KeyInfo&) override {
    for (std::size_t i = 0; i < items.size; ++i) below(key, "[[", "]]", [&] { items.visit(i); });
  }

 private:
  // Sub-tables come after all keys of a table, whatever the order of the declarations: TOML ends a
  // table at the next header.
  struct Level {
    std::string path, keys, tables;
  };

  void line(const char* key, const std::string& value, const KeyInfo& info,
            const std::string& choices = "") {
    if (!info.applies || info.unset) return;
    const std::string unit = *info.unit ? std::string(info.unit) + "; " : "";
    levels_.back().keys += fmt::format("{:<40} # {}{}{}\n", fmt::format("{} = {}", key, value),
                                       unit, choices, info.doc);
  }

  void below(const char* key, const char* open, const char* close,
             const std::function<void()>& inside) {
    const std::string path = (levels_.back().path.empty() ? "" : levels_.back().path + ".") + key;
    levels_.push_back({path, "", ""});
    inside();
    const Level done = levels_.back();
    levels_.pop_back();
    levels_.back().tables +=
        fmt::format("\n{}{}{}\n{}{}", open, path, close, done.keys, done.tables);
  }

  std::vector<Level> levels_{1};
};

}  // namespace

std::string scene_to_toml(const Scene& scene) {
  TomlWriter writer;
  Scene copy = scene;
  describe(writer, copy);
  return writer.text();
}

}  // namespace taut
