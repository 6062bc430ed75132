#include <fmt/format.h>

#include "taut/scene/scene_file.h"
#include "taut/scene/schema_catalogue.h"

namespace taut {

namespace {

constexpr const char* opening = R"(# Scene files

<!-- Generated from the declarations in src/taut/scene/schema*.cpp: change those, then run the test
     scene.SceneReference with TAUT_UPDATE=1 in the environment. -->

A scene is a [TOML](https://toml.io) file. Units are SI: m, kg, s, N. Whatever is left out has the
default of the tables below; whatever is not in these tables is an error. `taut check SCENE.toml`
says what is wrong or doubtful. On the command line `--set KEY=VALUE` changes a key:
`--set time.step=2e-3`, `--set cloth.k_stretch=600` (every cloth), `--set cloth.0.k_stretch=600`
(the first).

```toml
[time]
step = 5e-3
frames = 100

[[cloth]]
grid = { nodes = [41, 41], origin = [0, 0, 1], u = [1, 0, 0], v = [0, 1, 0] }
density = 0.15
pin = [{ corners = ["u0v0", "u1v0"] }]

[[solid]]
shape = "sphere"
radius = 0.2
translation = [0.5, 0.5, 0.6]
```

A *rotation* is `{ axis = [x, y, z], degrees = angle }`, right-handed, about an axis of any
length; programs may write `{ quaternion = [w, x, y, z] }`. Vectors are `[x, y, z]`.
)";

// A | would end the cell.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

std::string row(const CatalogueKey& key) {
  const std::string only = key.only_for.empty() ? "" : " Only for " + key.only_for + ".";
  const std::string standard =
      key.standard.empty() || key.standard == "required" ? key.standard : "`" + key.standard + "`";
  return fmt::format("| `{}` | {} | {} | {} | {} | {}{} |\n", key.name, cell(key.type),
                     cell(key.unit), cell(key.range), cell(standard), cell(key.doc),
                     only.empty() ? "" : "." + only);
}

}  // namespace

std::string scene_reference() {
  std::string text = opening;
  for (const CatalogueTable& table : schema_catalogue()) {
    text += table.path.empty() ? "\n## Top level\n\nBefore the first table.\n"
                               : fmt::format("\n## `{}`\n\n{}\n", table.heading(), table.doc);
    text += "\n| key | type | unit | range | default | meaning |\n|---|---|---|---|---|---|\n";
    for (const CatalogueKey& key : table.keys) text += row(key);
  }
  return text;
}

}  // namespace taut
