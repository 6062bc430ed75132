#pragma once
// All keys of the scene format as a list, for the reference page and for advice about misplaced
// keys.

#include <string>
#include <vector>

namespace taut {

struct CatalogueKey {
  std::string name, type, unit, range, standard, doc, only_for;
};

struct CatalogueTable {
  std::string path;   // "", "time", "cloth.pin"
  bool list = false;  // [[path]]
  std::string doc;
  std::vector<CatalogueKey> keys;
  std::string heading() const { return list ? "[[" + path + "]]" : "[" + path + "]"; }
};

// In the order of describe(); the first one is the top level.
std::vector<CatalogueTable> schema_catalogue();

}  // namespace taut
