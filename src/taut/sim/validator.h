#pragma once
// Judges values that were set in a program by the same declarations, in the same words, that judge
// a scene file: a visitor that reads everything and keeps what is wrong.
//
//   cloth.0.density = -1 kg/m² is out of range: expected above 0, at most 1e+06 kg/m²
//
// A complaint's path names the value as a scene file would, without its place in a file.

#include "taut/sim/schema.h"

namespace taut {

struct ValueComplaint {
  std::string path;  // "cloth.0.density"
  std::string text;  // the whole sentence, the path included
};

// Values of a World, a Scene or options that cannot be simulated: one line a complaint.
class InvalidWorld : public InputError {
 public:
  explicit InvalidWorld(std::vector<ValueComplaint> complaints);
  const std::vector<ValueComplaint>& complaints() const { return complaints_; }

 private:
  std::vector<ValueComplaint> complaints_;
};

class Validator final : public SchemaVisitor {
 public:
  void number(const char* key, double& value, const KeyInfo& info) override;
  void integer(const char* key, int& value, const KeyInfo& info) override;
  void flag(const char* key, bool&, const KeyInfo& info) override { note(key, info); }
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
  bool given(const char*, bool now) override { return now; }
  void exactly_one(std::span<const char* const> keys) override;
  void check(bool holds, const char* key, const std::string& message) override;

  // What belongs to no declaration: `what` follows the path and ": ".
  void complain(const std::string& path, const std::string& what);
  // The same with the whole sentence.
  void complain_whole(const std::string& path, const std::string& text);
  // Walks what lies below a path, such as "cloth.0.".
  void inside(const std::string& path, const std::function<void()>& described);
  bool ok() const { return complaints_.empty(); }
  // Throws InvalidWorld if there are complaints.
  void finish();

 protected:
  void tables(const char* key, const TableList& items, const KeyInfo& info) override;

 private:
  struct Level {
    std::string path;
    std::size_t earlier;                            // complaints before it
    std::vector<std::vector<std::string>> choices;  // of exactly_one, judged at the end
    std::vector<std::string> set;                   // keys that hold something
  };
  void note(const char* key, const KeyInfo& info);
  void judge(const char* key, double value, const KeyInfo& info);

  std::vector<Level> levels_{1};
  std::vector<ValueComplaint> complaints_;
};

}  // namespace taut
