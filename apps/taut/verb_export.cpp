#include <fmt/format.h>
#include <fmt/ranges.h>

#include "counted.h"
#include "frame_range.h"
#include "taut/base/error.h"
#include "taut/results/sequence_export.h"
#include "taut/sim/cloth_model.h"
#include "verbs.h"

namespace taut::app {

namespace {

// The usual ones of all formats.
std::vector<std::string> endings() {
  std::vector<std::string> all;
  for (const SequenceFormat& format : sequence_formats()) {
    const std::string_view several = format.endings;
    all.emplace_back(several.substr(0, several.find(' ')));
  }
  return all;
}

struct ExportArguments {
  std::string folder, out, up, frames, format;
  SequenceExportOptions options;
};

// --out is a file when it ends as those of a format do, else a folder; --format may say the rest.
void choose_target(ExportArguments& arguments) {
  namespace fs = std::filesystem;
  const fs::path out = arguments.out;
  const SequenceFormat* of_file = fs::is_directory(out) ? nullptr : sequence_format_of(out);
  if (!of_file && arguments.format.empty())
    throw CLI::ValidationError(
        "export", fmt::format("in which format? --format {}, or --out with a file that ends in {}",
                              fmt::join(export_format_names(), "|"), fmt::join(endings(), ", ")));
  if (of_file && !arguments.format.empty() && arguments.format != of_file->name)
    throw CLI::ValidationError(
        "export",
        fmt::format("--out {} is a file of the format {}, --format says {}; leave one out",
                    arguments.out, of_file->name, arguments.format));
  arguments.options.format = of_file ? of_file->name : arguments.format;
  arguments.options.folder = of_file ? out.parent_path() : out;
  if (of_file) arguments.options.file_name = out.filename().string();
  if (of_file && arguments.options.folder.empty()) arguments.options.folder = ".";
}

int export_frames(ExportArguments& arguments) {
  choose_target(arguments);
  const ResultFrames frames(arguments.folder);
  SequenceExportOptions& options = arguments.options;
  const FrameRange range = chosen_frames(arguments.frames, frames);
  options.first = range.first, options.last = range.last, options.stride = range.stride;
  if (options.folder.empty()) options.folder = frames.results().folder() / options.format;
  if (!arguments.up.empty()) options.up = arguments.up == "y" ? UpAxis::y : UpAxis::z;
  if (!frames.run_has_finished())
    fmt::print(stderr,
               "note: the run has not finished (it is running, or was interrupted); there are "
               "frames 0 to {} so far\n",
               frames.last_frame());
  SequenceExport sequence(frames, options);
  sequence.add_frames_until(options.last);
  sequence.finish();
  if (const auto others = sequence.files_of_other_frames(); !others.empty())
    fmt::print(stderr,
               "note: {} files of other frames stay in {} from an earlier export, such as {}; "
               "remove them if they do not belong here\n",
               others.size(), options.folder.string(), others.front().filename().string());
  fmt::print("{} of {} and {} written to {}\n", counted(sequence.frames_added(), "frame"),
             counted(frames.cloth().parts().size(), "cloth"),
             counted(frames.scene().solids.size(), "solid"), sequence.written_to());
  return 0;
}

std::string format_help() {
  std::string help;
  for (const SequenceFormat& format : sequence_formats())
    help += fmt::format("{}{}: {}", help.empty() ? "" : "; ", format.name, format.description);
  return help;
}

}  // namespace

std::vector<std::string> export_format_names() {
  std::vector<std::string> names;
  for (const SequenceFormat& format : sequence_formats()) names.emplace_back(format.name);
  return names;
}

void add_export_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand(
      "export",
      "Convert the frames of a simulation, finished or still running, for other programs");
  auto arguments = std::make_shared<ExportArguments>();
  verb->add_option("DIR", arguments->folder, "Results folder of `taut run`")->required();
  verb->add_option("--format", arguments->format, format_help())
      ->check(CLI::IsMember(export_format_names()));
  verb->add_option(
      "--out", arguments->out,
      "Folder to write to, or a file, whose ending says the format (default: DIR/FORMAT)");
  verb->add_option("--frames", arguments->frames,
                   "Only these, both included (default: all there are)")
      ->type_name("FIRST:LAST[:STEP]")
      ->check(frame_range_syntax());
  verb->add_option("--scale", arguments->options.scale,
                   "Lengths in the files: 100 makes centimetres of metres (default: 1)")
      ->check(above(0));
  verb->add_option(
          "--up", arguments->up,
          "Upward axis of the files: y turns (x, y, z) to (x, z, -y) (default: z; y for gltf)")
      ->check(CLI::IsMember({"y", "z"}));
  verb->footer(
      "Example: taut export out/ball --out ball.usda\n"
      "Example: taut export out/ball --format usd\n"
      "Example: taut export out/ball --format pc2 --scale 100 --up y --frames 0:40 --out maya\n"
      "Vertices keep their order, texture coordinates are kept, solids are exported as meshes. "
      "docs/formats.md says what is in the files "
      "and\n"
      "how to open them. `taut run SCENE --export FORMAT` exports while it runs.");
  verb->callback([arguments, &exit_code] { exit_code = export_frames(*arguments); });
}

}  // namespace taut::app
