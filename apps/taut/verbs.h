#pragma once
// The program's verbs, one file each. A verb adds itself as a subcommand; its callback returns by
// setting `exit_code`: 0 done, 1 failed, 2 bad usage. Errors are thrown as InputError and printed
// by main().

#include <CLI/CLI.hpp>

#include "argument_checks.h"

namespace taut::app {

void add_run_verb(CLI::App& app, int& exit_code);
void add_resume_verb(CLI::App& app, int& exit_code);
void add_check_verb(CLI::App& app, int& exit_code);
void add_bench_verb(CLI::App& app, int& exit_code);
void add_dump_verb(CLI::App& app, int& exit_code);
void add_solve_verb(CLI::App& app, int& exit_code);
void add_export_verb(CLI::App& app, int& exit_code);
void add_plot_verb(CLI::App& app, int& exit_code);
void add_ccd_verb(CLI::App& app, int& exit_code);
void add_render_verb(CLI::App& app, int& exit_code);
void add_view_verb(CLI::App& app, int& exit_code);

// Of `taut export` and `taut run --export`.
std::vector<std::string> export_format_names();

}  // namespace taut::app
