#include "taut/scene/schema_catalogue.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "taut/scene/scene.h"
#include "taut/scene/schema.h"
#include "taut/scene/toml_reader.h"
#include "taut/scene/toml_values.h"

namespace taut {

namespace {

class Cataloguer final : public SchemaVisitor {
 public:
  std::vector<CatalogueTable> result{{}};

  void number(const char* key, double& value, const KeyInfo& info) override {
    add(key, "number", to_toml(value), info);
  }
  void integer(const char* key, int& value, const KeyInfo& info) override {
    add(key, "integer", std::to_string(value), info);
  }
  void flag(const char* key, bool& value, const KeyInfo& info) override {
    add(key, "true or false", value ? "true" : "false", info);
  }
  void text(const char* key, std::string& value, const KeyInfo& info) override {
    add(key, "text", to_toml(value), info);
  }
  void file(const char* key, std::filesystem::path&, const KeyInfo& info) override {
    add(key, "file name", "", info);
  }
  void vector(const char* key, Vec3& value, const KeyInfo& info) override {
    add(key, "[x, y, z]", to_toml(value), info);
  }
  void rotation(const char* key, Eigen::Quaterniond& value, const KeyInfo& info) override {
    add(key, "rotation", to_toml(value), info);
  }
  void integers(const char* key, std::vector<Index>& value, const KeyInfo& info) override {
    add(key, info.count ? fmt::format("{} integers", info.count) : "integers", to_toml(value),
        info);
  }
  void choose(const char* key, int& value, std::span<const char* const> names,
              const KeyInfo& info) override {
    add(key, quoted(names), to_toml(std::string(names[static_cast<std::size_t>(value)])), info);
  }
  void choose_some(const char* key, std::vector<std::string>&, std::span<const char* const> names,
                   const KeyInfo& info) override {
    add(key, "array of " + quoted(names), "", info);
  }
  void table(const char* key, const KeyInfo& info, const std::function<void()>& inside) override {
    enter(key, false, info, inside);
  }
  bool given(const char*, bool now) override { return now; }
  void exactly_one(std::span<const char* const> keys) override {
    result[here_].doc += fmt::format(" Exactly one of `{}` is given.", fmt::join(keys, "`, `"));
  }
  void check(bool, const char*, const std::string&) override {}

 protected:
  void tables(const char* key, const TableList& items, const KeyInfo& info) override {
    enter(key, true, info, [&] {
      items.resize(1);
      items.visit(0);
      items.resize(0);
    });
  }

 private:
  static std::string quoted(std::span<const char* const> names) {
    return fmt::format("\"{}\"", fmt::join(names, "\", \""));
  }

  void add(const char* key, const std::string& type, const std::string& standard,
           const KeyInfo& info) {
    const std::string shown = info.required ? "required" : info.unset ? "" : standard;
    KeyInfo bare = info;
    bare.unit = "";
    result[here_].keys.push_back(
        {key, type, info.unit, range_text(bare), shown, info.doc, info.only_for});
  }

  void enter(const char* key, bool list, const KeyInfo& info, const std::function<void()>& inside) {
    const std::size_t outside = here_;
    const std::string path = (result[outside].path.empty() ? "" : result[outside].path + ".") + key;
    here_ = result.size();
    result.push_back({path, list, info.doc, {}});
    inside();
    here_ = outside;
  }

  std::size_t here_ = 0;
};

}  // namespace

std::vector<CatalogueTable> schema_catalogue() {
  Cataloguer cataloguer;
  Scene defaults;
  describe(cataloguer, defaults);
  return cataloguer.result;
}

}  // namespace taut
