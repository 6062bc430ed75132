#include "taut/io/usd.h"

#include <cstdlib>
#include <filesystem>

#include "taut/base/error.h"
#include "taut/io/child_process.h"
#include "taut/io/obj.h"
#include "taut/io/usd_script.h"

namespace taut {

namespace {

constexpr int refused = 3, without_pxr = 4;
constexpr std::chrono::seconds patience{120};

std::string python() {
  const char* chosen = std::getenv("TAUT_PYTHON");
  return chosen && *chosen ? chosen : "python3";
}

std::string last_lines(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text.size() <= 2000 ? text : "..." + text.substr(text.size() - 2000);
}

}  // namespace

TriangleMesh read_usd(const std::filesystem::path& path, const std::string& prim,
                      std::vector<std::string>* notes) {
  const SourcePlace file{path.string()};
  if (!std::filesystem::is_regular_file(path)) throw InputError(file, "is not there, or no file");
  // OpenUSD would look for a bare name elsewhere, too.
  const ChildEnd end = run_child(
      {python(), "-c", usd_script, std::filesystem::absolute(path).string(), prim}, patience);
  const std::string get_it =
      "USD meshes are read by Python with OpenUSD: pip install usd-core in an environment of your "
      "own and name its Python in "
      "TAUT_PYTHON, or export the mesh as OBJ or PLY";
  switch (end.outcome) {
    case ChildEnd::Outcome::not_found:
      throw InputError(file,
                       "cannot be read without Python (" + python() + " is not there); " + get_it);
    case ChildEnd::Outcome::too_slow:
      throw InputError(file, "was not read within two minutes; export the mesh as OBJ or PLY");
    case ChildEnd::Outcome::killed:
      throw InputError(file,
                       "cannot be read: " + python() + " was killed; " + last_lines(end.errors));
    case ChildEnd::Outcome::exited:
      break;
  }
  if (end.code == refused) throw InputError(file, last_lines(end.errors));
  if (end.code == without_pxr)
    throw InputError(file, "cannot be read: " + python() + " has no module pxr that works (" +
                               last_lines(end.errors) + "); " + get_it);
  if (end.code != 0)
    throw InputError(file, "cannot be read; " + python() + " said: " + last_lines(end.errors));
  return parse_obj(path.string() + " (as OBJ)", end.output, notes);
}

}  // namespace taut
