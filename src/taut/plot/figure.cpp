#include "taut/plot/figure.h"

#include <algorithm>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/plot/gnuplot_process.h"

namespace taut {

namespace {

bool is_svg(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending != ".svg" && ending != ".png")
    throw InputError({path.string()},
                     "ends in '" + ending + "'; a figure's file ends in .svg or .png");
  return ending == ".svg";
}

}  // namespace

void draw_figure(const Figure& figure, const std::filesystem::path& path) {
  const GnuplotJob job = gnuplot_job(figure, is_svg(path));
  write_file(path, run_gnuplot(job));
}

void check_figure_file(const std::filesystem::path& path) {
  is_svg(path);
  run_gnuplot({"set print 'out'\nprint 'gnuplot is there'\n", {}, "out"});
}

}  // namespace taut
