#include <fmt/format.h>

#include <new>

#include "taut/base/error.h"
#include "verbs.h"
#ifdef TAUT_WITH_CHOLMOD
#include "taut_cholmod/cholmod.h"
#endif
#ifdef TAUT_WITH_PARDISO
#include "taut_pardiso/pardiso.h"
#endif

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
  app.footer("Example: taut run scenes/ball.toml\n`taut VERB --help` tells more about each verb.");
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
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  } catch (const taut::InputError& error) {
    fmt::print(stderr, "taut: {}\n", error.what());
    return 1;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "taut: not enough memory; use a smaller scene\n");
    return 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "taut: unexpected: {}; please report this\n", error.what());
    return 1;
  }
  return exit_code;
}
