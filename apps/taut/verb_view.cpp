#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "interrupt.h"
#include "verbs.h"
#include "view/open_browser.h"
#include "view/run_state.h"
#include "view/view_server.h"

namespace taut::app {

namespace {

struct ViewArguments {
  std::string folder;
  int port = 0;
  bool no_open = false;
};

std::string state_line(const ResultFiles& files) {
  const auto state = RunStateReader(files).read();
  const int frames = state.at("frames");
  const std::string status = state.at("status");
  if (status == "empty") return "no result of `taut run` yet; what comes will be shown";
  return fmt::format("{}, {} frames so far", status, frames);
}

int view(const ViewArguments& arguments) {
  const ResultFiles files(arguments.folder);
  ViewServer server(files, read_page(page_folder()), arguments.port);
  const auto& interrupted = interrupt_flag();
  fmt::print("{}: {}\n\n  {}\n\nCtrl-C ends it.\n", arguments.folder, state_line(files),
             server.address());
  std::fflush(stdout);
  if (!arguments.no_open && !open_browser(server.address()))
    fmt::print(stderr, "found no browser to open; open the address above in yours\n");
  std::thread serving([&] { server.run(); });
  while (!interrupted) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  server.stop();
  serving.join();
  return 0;
}

}  // namespace

void add_view_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb =
      app.add_subcommand("view", "Look at a result in the browser, live while it is computed");
  auto arguments = std::make_shared<ViewArguments>();
  verb->add_option("DIR", arguments->folder,
                   "Results folder of `taut run`, finished, running or still empty")
      ->required();
  verb->add_option("--port", arguments->port,
                   "Port of 127.0.0.1 to listen on (default: a free one)")
      ->check(between(1, 65535));
  verb->add_flag("--no-open", arguments->no_open, "Print the address, open no browser");
  verb->footer(
      "Example: taut view out/ball\n"
      "Reads DIR only and changes nothing. Only this machine can reach it; the address holds a key "
      "that others on it do not know.");
  verb->callback([arguments, &exit_code] { exit_code = view(*arguments); });
}

}  // namespace taut::app
