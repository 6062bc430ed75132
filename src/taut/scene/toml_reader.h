#pragma once
// Fills the fields that describe() names from a TOML document, and complains about everything that
// does not fit.

#include <toml++/toml.h>

#include <filesystem>
#include <map>
#include <vector>

#include "taut/scene/complaints.h"
#include "taut/sim/schema.h"

namespace taut {

class TomlReader final : public SchemaVisitor {
 public:
  // `home`: advice where a key that is unknown in its table belongs, "" when nowhere.
  using Home = std::function<std::string(const std::string& key)>;
  TomlReader(const toml::table& document, std::filesystem::path folder, Home home,
             Complaints& complaints);
  // After the walk: complains about the top-level keys that were not described.
  void finish() { complain_of_unknown_keys(); }
  // Where each key that was read stands, by its path.
  const std::map<std::string, SourcePlace>& places() const { return places_; }

  void number(const char* key, double& value, const KeyInfo& info) override;
  void integer(const char* key, int& value, const KeyInfo& info) override;
  void flag(const char* key, bool& value, const KeyInfo& info) override;
  void text(const char* key, std::string& value, const KeyInfo& info) override;
  void file(const char* key, std::filesystem::path& value, const KeyInfo& info) override;
  void vector(const char* key, Vec3& value, const KeyInfo& info) override;
  void rotation(const char* key, Eigen::Quaterniond& value, const KeyInfo& info) override;
  void integers(const char* key, std::vector<Index>& value, const KeyInfo& info) override;
  void choose(const char* key, int& value, std::span<const char* const> names,
              const KeyInfo& info) override;
  void choose_some(const char* key, std::vector<std::string>& value,
                   std::span<const char* const> names, const KeyInfo& info) override;
  void table(const char* key, const KeyInfo& info, const std::function<void()>& inside) override;
  bool given(const char* key, bool now) override;
  void exactly_one(std::span<const char* const> keys) override;
  void check(bool holds, const char* key, const std::string& message) override;

 protected:
  void tables(const char* key, const TableList& items, const KeyInfo& info) override;

 private:
  struct Level {
    const toml::table* table;
    std::string path;  // "" or "cloth.0."
    std::vector<std::string> known;
    std::size_t earlier_complaints;
  };
  Level& level() { return levels_.back(); }
  // The key's value; null, with a complaint where due, when it is not there or does not apply.
  const toml::node* take(const char* key, const KeyInfo& info);
  bool to_number(const char* key, const toml::node& node, double& value, const KeyInfo& info);
  bool to_integer(const char* key, const toml::node& node, int& value, const KeyInfo& info);
  bool to_numbers(const char* key, const toml::node& node, std::span<double> values,
                  const KeyInfo& info);
  bool in_range(const char* key, const toml::node& node, double value, const KeyInfo& info);
  int index_of(const char* key, const toml::node& node, std::span<const char* const> names);
  void inside_table(const toml::table& table, const std::string& path,
                    const std::function<void()>& inside);
  void complain(const toml::node& node, const char* key, const std::string& message);
  void wrong_type(const toml::node& node, const char* key, const std::string& expected,
                  const KeyInfo& info);
  void complain_of_unknown_keys();

  std::vector<Level> levels_;
  std::map<std::string, SourcePlace> places_;
  std::filesystem::path folder_;
  Home home_;
  Complaints& complaints_;
};

}  // namespace taut
