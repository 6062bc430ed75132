#include <fmt/format.h>
#include <unistd.h>

#include <cmath>

#include "frame_range.h"
#include "render/film.h"
#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/results/frame_picture.h"
#include "taut/sim/cloth_model.h"
#include "verbs.h"

namespace taut::app {

namespace {

namespace fs = std::filesystem;

struct RenderArguments {
  std::string folder, out, size = "1280x720", frames, from, at;
  PictureOptions options;
  std::optional<int> frame;
  double frames_per_second = 30.0, speed = 1.0;
  int threads = 0, sheet = 0;
  bool checker = false, plain = false, no_ground = false, frames_only = false;
};

// "a,b,c" or "WxH": numbers with this mark between them; none when it is something else.
template <class T>
std::vector<T> numbers_in(const std::string& text, char mark) {
  std::vector<T> numbers;
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  for (char between = mark; between == mark; between = static_cast<char>(in.get())) {
    T number{};
    if (!(in >> number) || !std::isfinite(static_cast<double>(number))) return {};
    numbers.push_back(number);
    if (in.peek() == std::char_traits<char>::eof()) return numbers;
  }
  return {};
}

CLI::Validator point_syntax() {
  return {[](const std::string& text) {
            return numbers_in<double>(text, ',').size() == 3
                       ? std::string()
                       : "'" + text +
                             "' is no point; X,Y,Z in metres was expected, such as 2,-3,1.5";
          },
          ""};
}

CLI::Validator size_syntax() {
  return {[](const std::string& text) {
            const std::vector<int> size = numbers_in<int>(text, 'x');
            const bool good = size.size() == 2 && size[0] >= 16 && size[1] >= 16 &&
                              size[0] <= 16384 && size[1] <= 16384;
            return good ? std::string()
                        : "'" + text +
                              "' is no size; WIDTHxHEIGHT in pixels, 16 to 16384 each, was "
                              "expected, such as 1280x720";
          },
          ""};
}

Vec3 point_of(const std::string& text) {
  const std::vector<double> numbers = numbers_in<double>(text, ',');
  return {numbers[0], numbers[1], numbers[2]};
}

PictureOptions picture_options(const RenderArguments& arguments) {
  PictureOptions options = arguments.options;
  const std::vector<int> size = numbers_in<int>(arguments.size, 'x');
  options.width = size[0];
  options.height = size[1];
  if (!arguments.from.empty()) options.from = point_of(arguments.from);
  if (!arguments.at.empty()) options.at = point_of(arguments.at);
  options.pattern = arguments.checker ? Pattern::checker
                    : arguments.plain ? Pattern::none
                                      : Pattern::grid;
  options.ground = !arguments.no_ground;
  return options;
}

std::vector<int> frames_of(const FrameRange& range) {
  std::vector<int> frames;
  for (int k = range.first; k <= range.last; k += range.stride) frames.push_back(k);
  return frames;
}

// The frame to be seen in each picture of a film: the one nearest in time.
std::vector<int> film_frames(const RenderArguments& arguments, const FrameRange& range,
                             double interval) {
  const double duration = (range.last - range.first) * interval / arguments.speed;
  const int pictures =
      static_cast<int>(std::floor(duration * arguments.frames_per_second + 1e-9)) + 1;
  std::vector<int> frames;
  for (int k = 0; k < pictures; ++k) {
    const double frame = range.first + k / arguments.frames_per_second * arguments.speed / interval;
    frames.push_back(std::min(range.last, static_cast<int>(std::lround(frame))));
  }
  return frames;
}

int draw_film(const RenderArguments& arguments, const ResultFrames& result, const fs::path& out) {
  const FrameRange range = chosen_frames(arguments.frames, result);
  const std::vector<int> frames = film_frames(arguments, range, result.interval());
  const bool encode = out.extension() == ".mp4" && !arguments.frames_only && has_ffmpeg();
  const fs::path folder = out.extension() == ".mp4"
                              ? fs::path(fs::path(out).replace_extension().string() + "_frames")
                              : out;
  const fs::path film = out.extension() == ".mp4" ? out : fs::path(out.string() + ".mp4");
  if (out.extension() == ".mp4" && !encode && !arguments.frames_only)
    fmt::print(stderr,
               "note: there is no ffmpeg here (Debian: apt-get install ffmpeg); PNG files are made "
               "instead of a film\n");
  const auto writer = encode ? make_mp4_writer(out, arguments.frames_per_second)
                             : make_png_writer(folder, arguments.frames_per_second, film);
  const FramePictures pictures(result.scene(), result.cloth(), result.results(), frames,
                               picture_options(arguments));
  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  Image picture;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (terminal) fmt::print(stderr, "\r\033[Kpicture {} of {}", k + 1, frames.size());
    if (k == 0 || frames[k] != frames[k - 1]) picture = pictures.draw(frames[k]);
    writer->add(picture);
  }
  if (terminal) fmt::print(stderr, "\r\033[K");
  fmt::print("{}\n", writer->finish());
  return 0;
}

bool wants_sheet(const RenderArguments& arguments, const fs::path& out) {
  return arguments.sheet > 0 || (!arguments.frame && out.stem().string().ends_with("sheet"));
}

int render_result(RenderArguments arguments, bool size_given) {
  if (arguments.frame && fs::path(arguments.out).extension() != ".png")
    throw CLI::ValidationError("--frame",
                               "a film has all frames, --frame chooses one of a still: give --out "
                               "FILE.png, or --frames FIRST:LAST");
  if (arguments.threads > 0) set_thread_count(arguments.threads);
  const fs::path out = arguments.out;
  const ResultFrames result(arguments.folder);
  if (out.extension() == ".mp4" || out.extension().empty())
    return draw_film(arguments, result, out);
  if (wants_sheet(arguments, out)) {
    if (!size_given) arguments.size = "480x400";
    const std::vector<int> all = frames_of(chosen_frames(arguments.frames, result));
    std::vector<int> frames;
    for (const int k :
         spread_frames(static_cast<int>(all.size()) - 1, arguments.sheet > 0 ? arguments.sheet : 6))
      frames.push_back(all[static_cast<std::size_t>(k)]);
    draw_contact_sheet(out, result.scene(), result.cloth(), result.results(), frames,
                       picture_options(arguments));
  } else {
    const int last = last_frame_said(result), frame = arguments.frame.value_or(last);
    if (frame > last)
      throw InputError({arguments.folder},
                       fmt::format("has the frames 0 to {}; {} was asked for", last, frame));
    const std::vector<int> frames{frame};
    write_png(out, FramePictures(result.scene(), result.cloth(), result.results(), frames,
                                 picture_options(arguments))
                       .draw(frame));
  }
  fmt::print("{}\n", out.string());
  return 0;
}

CLI::Validator out_syntax() {
  return {
      [](const std::string& text) {
        const std::string extension = fs::path(text).extension().string();
        return extension == ".png" || extension == ".mp4" || (extension.empty() && !text.empty())
                   ? std::string()
                   : "'" + text + "' is neither FILE.png nor FILE.mp4, nor a folder for PNG files";
      },
      ""};
}

}  // namespace

void add_render_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand(
      "render", "Draw a picture, a sheet of pictures or a film of a simulation; needs no display");
  auto arguments = std::make_shared<RenderArguments>();
  verb->add_option("DIR", arguments->folder,
                   "Results folder of `taut run`, also one that is still running")
      ->required();
  verb->add_option("--out", arguments->out,
                   "FILE.png: a still, or with --sheet or the name sheet.png some frames side by "
                   "side; FILE.mp4: a film (ffmpeg); FOLDER: a film's "
                   "pictures as PNG files")
      ->required()
      ->type_name("FILE.png|FILE.mp4|FOLDER")
      ->check(out_syntax());
  CLI::Option* frame =
      verb->add_option("--frame", arguments->frame, "Frame of a still (default: the last)")
          ->check(at_least(0));
  CLI::Option* size =
      verb->add_option("--size", arguments->size,
                       "Pixels of a picture (default: 1280x720; of a sheet's pictures 480x400)")
          ->type_name("WIDTHxHEIGHT")
          ->check(size_syntax());
  verb->add_option("--samples", arguments->options.samples,
                   "Rays a pixel: more is smoother and slower (default: 16)")
      ->check(between(1, 1024));
  verb->add_option("--sheet", arguments->sheet, "So many frames side by side")
      ->check(between(1, 100))
      ->excludes(frame);
  verb->add_option("--frames", arguments->frames, "Of a film or sheet only these (default: all)")
      ->type_name("FIRST:LAST[:STEP]")
      ->check(frame_range_syntax())
      ->excludes(frame);
  verb->add_option("--fps", arguments->frames_per_second,
                   "Pictures a second of a film (default: 30)")
      ->check(between(1.0, 240.0));
  verb->add_option(
          "--speed", arguments->speed,
          "Seconds of simulated time in a second of a film: 0.25 is slow motion (default: 1)")
      ->check(between(1e-4, 1e4));
  verb->add_option("--from", arguments->from,
                   "Where the camera is (default: as near as all is in view)")
      ->type_name("X,Y,Z")
      ->check(point_syntax());
  verb->add_option("--at", arguments->at,
                   "What is in the middle (default: the middle of what there is)")
      ->type_name("X,Y,Z")
      ->check(point_syntax());
  verb->add_option("--fov", arguments->options.vertical_field_of_view_deg,
                   "Degrees from the bottom to the top of the picture (default: 28)")
      ->check(between(1.0, 170.0));
  CLI::Option* checker =
      verb->add_flag("--checker", arguments->checker,
                     "Squares on the cloth from its texture coordinates, instead of lines");
  verb->add_flag("--plain", arguments->plain, "Neither squares nor lines on the cloth")
      ->excludes(checker);
  verb->add_flag("--no-ground", arguments->no_ground, "No ground below");
  verb->add_flag("--frames-only", arguments->frames_only,
                 "A film's pictures as PNG files, and the command that makes the film");
  verb->add_option("--threads", arguments->threads, "Threads to use (default: all processors)")
      ->check(between(1, 1024));
  verb->footer(
      "Example: taut render out/ball --out ball.mp4\n"
      "Example: taut render out/ball --out ball.png --frame 40 --checker --from 1.5,-2.5,1.2 --at "
      "0,0,0.5");
  verb->callback([=, &exit_code] { exit_code = render_result(*arguments, size->count() > 0); });
}

}  // namespace taut::app
