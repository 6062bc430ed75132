#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <new>

#include "taut/base/error.h"
#include "verbs.h"
#ifdef TAUT_WITH_CHOLMOD
#include "taut_cholmod/cholmod.h"
#endif
#ifdef TAUT_WITH_PARDISO
#include "taut_pardiso/pardiso.h"
#endif

namespace {

namespace fs = std::filesystem;

// What did not get through to a full disk is an error: a script must not take half an answer for a
// whole one.
bool output_is_lost() {
  return std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !std::cout.flush();
}

int fail(const std::string& message) {
  fmt::print(stderr, "taut: {}\n", message);
  return 1;
}

std::string describe(const fs::filesystem_error& error) {
  const fs::path& path = error.path2().empty() ? error.path1() : error.path2();
  const char* advice = error.code() == std::errc::not_a_directory
                           ? "a part of this name is a file, not a folder: give another"
                           : "check the folder's permissions and free space, or give another";
  return fmt::format("{}: {}; {}", path.string(), error.code().message(), advice);
}

std::vector<std::string> verbs_of(const CLI::App& app) {
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    verbs.push_back(verb->get_name());
  return verbs;
}

// "fly": no verb, and what may have been meant.
std::string unknown_verb(const std::vector<std::string>& verbs, const std::string& word) {
  const std::string near = taut::nearest_name(word, verbs);
  return fmt::format("'{}' is no verb of taut; {}", word,
                     near.empty() ? fmt::format("there are {}", fmt::join(verbs, ", "))
                                  : "did you mean '" + near + "'?");
}

// `./taut`, the launcher, has two verbs of its own.
std::string footer() {
  std::string text =
      "Example: taut run scenes/ball.toml\n`taut VERB --help` tells more about each verb.";
  if (std::getenv("TAUT_LAUNCHER"))
    text +=
        "\nOf the launcher ./taut itself: `./taut test` builds and runs the tests, `./taut setup "
        "pardiso` fetches Intel oneMKL for the "
        "solver pardiso.";
  return text;
}

int run_program(CLI::App& app, int argc, char** argv) {
  int exit_code = 0;
  taut::app::add_run_verb(app, exit_code);
  taut::app::add_resume_verb(app, exit_code);
  taut::app::add_check_verb(app, exit_code);
  taut::app::add_bench_verb(app, exit_code);
  taut::app::add_dump_verb(app, exit_code);
  taut::app::add_solve_verb(app, exit_code);
  taut::app::add_export_verb(app, exit_code);
  taut::app::add_plot_verb(app, exit_code);
  taut::app::add_ccd_verb(app, exit_code);
  taut::app::add_render_verb(app, exit_code);
  taut::app::add_view_verb(app, exit_code);
  const std::vector<std::string> verbs = verbs_of(app);
  if (argc > 1 && argv[1][0] != '-' && std::ranges::find(verbs, argv[1]) == verbs.end()) {
    fail(unknown_verb(verbs, argv[1]));
    return 2;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const taut::InputError& error) {
    return fail(error.what());
  } catch (const std::bad_alloc&) {
    return fail("not enough memory; use a smaller scene");
  } catch (const fs::filesystem_error& error) {
    return fail(describe(error));
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return 1;  // main says so
    return fail(fmt::format("unexpected: {}; please report this", error.what()));
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
#ifdef TAUT_WITH_CHOLMOD
  taut::register_cholmod();
#endif
#ifdef TAUT_WITH_PARDISO
  taut::register_pardiso();
#endif
  CLI::App app{"Taut: cloth dynamics whose cost does not grow with stiffness", "taut"};
  app.set_version_flag("--version", std::string("taut ") + TAUT_VERSION);
  app.require_subcommand(1);
  app.footer(footer());
  const int exit_code = run_program(app, argc, argv);
  if (!output_is_lost()) return exit_code;
  return fail(
      "standard output could not be written (is the disk full?): what was printed is not complete");
}
