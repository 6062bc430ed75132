#pragma once
// What can be set, written down once: describe functions name every value with its meaning, unit
// and range. Visitors walk them: the judge of values (sim/validator.h), and in scene/ the reader
// and the writer of TOML and the reference page. A new key is one line in a describe function.
//
// A visitor is handed references: a reader assigns to them, the others only read. Before the walk
// the fields hold the defaults (reader, reference) or the values (writer, validator).

#include <Eigen/Geometry>
#include <filesystem>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "taut/base/error.h"
#include "taut/base/types.h"

namespace taut {

struct KeyInfo {
  const char* doc = "";
  const char* unit = "";  // "m/s"; empty for plain numbers
  // inclusive, unless above_min; of each entry of an array
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();  // inclusive
  bool above_min = false;                                // min itself is too small
  // the reader insists on the key, where it applies
  bool required = false;
  // the field's value stands for "not given": the writer leaves the key out
  bool unset = false;
  // entries of an integer array, 0: any number
  std::size_t count = 0;
  // false: the key makes no sense beside the others, see only_for
  bool applies = true;
  // "a sphere or cylinder": what has this key
  const char* only_for = "";
  const char* hint = "";  // added to messages about a wrong value
};

class SchemaVisitor {
 public:
  virtual ~SchemaVisitor() = default;
  virtual void number(const char* key, double& value, const KeyInfo& info) = 0;
  virtual void integer(const char* key, int& value, const KeyInfo& info) = 0;
  virtual void flag(const char* key, bool& value, const KeyInfo& info) = 0;
  virtual void text(const char* key, std::string& value, const KeyInfo& info) = 0;
  // An existing file; the reader makes a relative path absolute, starting from the scene file's
  // folder.
  virtual void file(const char* key, std::filesystem::path& value, const KeyInfo& info) = 0;
  virtual void vector(const char* key, Vec3& value, const KeyInfo& info) = 0;
  // { axis = [x, y, z], degrees = angle } or { quaternion = [w, x, y, z] }.
  virtual void rotation(const char* key, Eigen::Quaterniond& value, const KeyInfo& info) = 0;
  virtual void integers(const char* key, std::vector<Index>& value, const KeyInfo& info) = 0;
  // One of `names`: value is its index.
  virtual void choose(const char* key, int& value, std::span<const char* const> names,
                      const KeyInfo& info) = 0;
  // Any number of `names`, none of them twice.
  virtual void choose_some(const char* key, std::vector<std::string>& value,
                           std::span<const char* const> names, const KeyInfo& info) = 0;
  // [key], described by `inside`.
  virtual void table(const char* key, const KeyInfo& info, const std::function<void()>& inside) = 0;

  // enum with enumerators 0, 1, 2, ... in the order of `names`.
  template <class Enum>
  void choice(const char* key, Enum& value, std::span<const char* const> names,
              const KeyInfo& info) {
    int index = static_cast<int>(value);
    choose(key, index, names, info);
    value = static_cast<Enum>(index);
  }
  // [[key]], one table for each item, described by inside(item).
  template <class T, class Inside>
  void list(const char* key, std::vector<T>& items, const KeyInfo& info, Inside&& inside) {
    tables(key,
           {items.size(), [&](std::size_t n) { items.resize(n); },
            [&](std::size_t i) { inside(items[i]); }},
           info);
  }

  // Is the key in the file? Where there is no file: `now`.
  virtual bool given(const char* key, bool now) = 0;
  // The file must hold exactly one of these keys.
  virtual void exactly_one(std::span<const char* const> keys) = 0;
  // A condition that a range cannot say. When it fails the reader reports `message` at `key`
  // (skipped when this table has errors already).
  virtual void check(bool holds, const char* key, const std::string& message) = 0;

 protected:
  struct TableList {
    std::size_t size;
    std::function<void(std::size_t)> resize;
    std::function<void(std::size_t)> visit;
  };
  virtual void tables(const char* key, const TableList& items, const KeyInfo& info) = 0;
};

// "from 1e-7 to 0.1 s", "above 0 kg": the allowed values; "" when all are.
std::string range_text(const KeyInfo& info);
// What is wrong with a value, to be put behind its name: " = -1 kg is out of range: expected above
// 0 kg", " = inf is not a finite number: give a number that is"; "" when nothing is. The one place
// where numbers are judged.
std::string problem_of(double value, const KeyInfo& info);
// "\"x\" is not known: expected one of ...; did you mean ...?"
std::string unknown_name(const std::string& name, std::span<const char* const> names);

}  // namespace taut
