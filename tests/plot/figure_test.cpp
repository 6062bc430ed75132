// Figures, read back from the SVG that gnuplot made of them.

#include "taut/plot/figure.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <regex>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/plot/gnuplot_script.h"
#include "taut/plot/plot_layout.h"

namespace taut {
namespace {

namespace fs = std::filesystem;

class FigureFile : public ::testing::Test {
 protected:
  FigureFile()
      : folder_(fs::temp_directory_path() / ("taut_figure_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~FigureFile() override { fs::remove_all(folder_); }
  std::string svg_of(const Figure& figure) const {
    draw_figure(figure, folder_ / "f.svg");
    return read_file(folder_ / "f.svg");
  }
  fs::path folder_;
};

Figure one_curve(Curve curve, Axis x = {}, Axis y = {}) {
  return {.title = "", .note = "", .panels = {{"", x, y, {std::move(curve)}, {}}}};
}

// The points of the first path drawn in a colour, in the SVG's units (y downwards).
std::vector<PlotPoint> path_in(const std::string& svg, const std::string& rgb) {
  const std::regex path("<path stroke='" + rgb + "'[^>]*d='([^']*)'");
  for (auto m = std::sregex_iterator(svg.begin(), svg.end(), path); m != std::sregex_iterator();
       ++m) {
    const std::string d = (*m)[1];
    std::vector<PlotPoint> points;
    const std::regex number("(-?[0-9.]+),(-?[0-9.]+)");
    for (auto n = std::sregex_iterator(d.begin(), d.end(), number); n != std::sregex_iterator();
         ++n)
      points.push_back({std::stod((*n)[1]), std::stod((*n)[2])});
    if (points.size() > 2) return points;
  }
  return {};
}

constexpr const char* first_colour = "rgb\\(  0, 114, 178\\)";

TEST_F(FigureFile, PointsStandWhereTheAxesPutThem) {
  const auto linear =
      path_in(svg_of(one_curve({"", {{0, 0}, {1, 10}, {2, 20}, {4, 0}}})), first_colour);
  ASSERT_EQ(linear.size(), 4u);
  const double dx = linear[1].x - linear[0].x, dy = linear[1].y - linear[0].y;
  EXPECT_GT(dx, 50);
  EXPECT_LT(dy, -50);  // upwards
  EXPECT_NEAR(linear[2].x - linear[1].x, dx, 0.2);
  EXPECT_NEAR(linear[2].y - linear[1].y, dy, 0.2);
  EXPECT_NEAR(linear[3].x - linear[2].x, 2 * dx, 0.3);
  EXPECT_NEAR(linear[3].y, linear[0].y, 0.2);

  const Axis log{"", AxisScale::logarithmic};
  const auto logarithmic =
      path_in(svg_of(one_curve({"", {{1, 1e-3}, {10, 1e-2}, {100, 1e-1}, {1000, 1e-3}}}, log, log)),
              first_colour);
  ASSERT_EQ(logarithmic.size(), 4u);
  EXPECT_NEAR(logarithmic[2].x - logarithmic[1].x, logarithmic[1].x - logarithmic[0].x, 0.2);
  EXPECT_NEAR(logarithmic[2].y - logarithmic[1].y, logarithmic[1].y - logarithmic[0].y, 0.2);
  EXPECT_LT(logarithmic[1].y, logarithmic[0].y);
}

TEST_F(FigureFile, WhatCannotBeDrawnIsAGap) {
  const Axis log{"", AxisScale::logarithmic};
  // Three points, a gap, three points: two pieces, so the first of them has three points.
  for (const double hole : {double(NAN), double(INFINITY), 0.0, -1.0}) {
    const auto piece =
        path_in(svg_of(one_curve({"", {{1, 1}, {2, 2}, {3, 1}, {4, hole}, {5, 2}, {6, 1}, {7, 2}}},
                                 {}, log)),
                first_colour);
    // gnuplot writes the pieces of a curve into one path.
    EXPECT_EQ(piece.size(), 6u) << hole;
  }
  const std::string empty = svg_of(one_curve({"nothing", {{1, NAN}, {2, -1}}}, {}, log));
  EXPECT_NE(empty.find("no data"), std::string::npos);
  EXPECT_NE(empty.find("nothing"), std::string::npos);
  EXPECT_NE(svg_of({.title = "t", .note = "", .panels = {{}}}).find("no data"), std::string::npos);
}

TEST_F(FigureFile, TextIsNeverACommand) {
  const fs::path made = folder_ / "made";
  const std::string command = "touch " + made.string();
  const std::string bad[] = {
      "it's '; system('" + command + "'); '",     "`" + command + "`",
      "\"; system(\"" + command + "\"); \"",      "a\nsystem('" + command + "')\n",
      "$(" + command + ") @x {/Bold b} x_1^2 \\", "<script>&amp;"};
  for (const std::string& text : bad) {
    Figure figure = one_curve({text, {{0, 0}, {1, 1}, {2, 0}}}, {text}, {text});
    figure.title = figure.note = figure.panels[0].title = text;
    figure.panels.push_back({text, {text}, {text}, {}, {{{text}, {text}, {1.0}, {text}, text}}});
    const std::string svg = svg_of(figure);
    EXPECT_FALSE(fs::exists(made)) << text;
    EXPECT_EQ(svg.find("<script>"), std::string::npos);
  }
  const std::string svg = svg_of(one_curve({"it's x_1 {/b} & <y>", {{0, 0}, {1, 1}}}));
  EXPECT_NE(svg.find("x_1 {/b} &amp; &lt;y"), std::string::npos);
  EXPECT_NE(svg.find("it"), std::string::npos);
  EXPECT_EQ(gnuplot_string("it's\na"), "'it''s a'");
}

TEST_F(FigureFile, TwentyCurvesLookDifferent) {
  Figure figure{.title = "", .note = "", .panels = {{}}};
  for (int c = 0; c < 28; ++c)
    figure.panels[0].curves.push_back(
        {"c" + std::to_string(c), {{0, double(c)}, {1, 1.0 + c}, {2, 2.0 + c}}, CurveStyle::line});
  const std::string script = gnuplot_job(figure, true).script;
  std::vector<std::string> looks;
  const std::regex look("with lines (lc rgb [^ ]+ dt [^ ]+)");
  for (auto m = std::sregex_iterator(script.begin(), script.end(), look);
       m != std::sregex_iterator(); ++m)
    looks.push_back((*m)[1]);
  ASSERT_EQ(looks.size(), 28u);
  std::ranges::sort(looks);
  EXPECT_TRUE(std::ranges::adjacent_find(looks) == looks.end());
  const std::string svg = svg_of(figure);
  for (int c = 0; c < 28; ++c)
    EXPECT_NE(svg.find(">c" + std::to_string(c) + "<"), std::string::npos) << c;
}

TEST_F(FigureFile, SharedLegendNamesEachCurveOnceAndKeepsItsLook) {
  Figure figure{.title = "",
                .note = "",
                .panels = {{"", {}, {}, {{"a", {{0, 1}, {1, 1}}}, {"b", {{0, 2}, {1, 2}}}}, {}},
                           {"", {}, {}, {{"b", {{0, 1}, {1, 3}}}}, {}}},
                .columns = 2,
                .shared_legend = true};
  const std::string script = gnuplot_job(figure, true).script;
  const auto count = [&](const std::string& text) {
    int n = 0;
    for (std::size_t at = script.find(text); at != std::string::npos;
         at = script.find(text, at + 1))
      ++n;
    return n;
  };
  EXPECT_EQ(count("title 'a'"), 1);
  EXPECT_EQ(count("title 'b'"), 1);
  EXPECT_EQ(count("'#D55E00'"), 3);  // b's: two curves and the legend
}

TEST_F(FigureFile, HeatMapColoursCellsInOrder) {
  HeatMap map{{"r0", "r1"},           {"c0", "c1"}, {1, 10, 100, NAN},
              {"1", "10", "100", ""}, "ms",         AxisScale::logarithmic};
  const std::string svg = svg_of({.title = "", .note = "", .panels = {{"", {}, {}, {}, {map}}}});
  for (const char* text : {">r0<", ">r1<", ">c1<", ">100<", ">ms<"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  // The lowest, middle and highest colour of viridis, and the grey of the empty cell.
  for (const char* colour : {"rgb( 68,   1,  84)", "rgb(253, 231,  37)", "rgb(228, 228, 228)"})
    EXPECT_NE(svg.find(colour), std::string::npos) << colour;
}

TEST_F(FigureFile, PanelsLeaveRoomForTheAxesThatAreWritten) {
  const auto gap = [](const char* first_label, int columns) {
    Figure figure{.title = "", .note = "", .panels = {{}, {}, {}, {}}, .columns = columns};
    figure.panels[0].x.label = first_label, figure.panels[3].x.label = "time";
    const PlotLayout layout = lay_out(figure);
    for (const PlotBox& box : layout.axes) {
      EXPECT_TRUE(box.left > 50 && box.bottom > 40 && box.right < layout.width &&
                  box.top < layout.height);
      EXPECT_TRUE(box.right > box.left + 100 && box.top > box.bottom + 100);
    }
    return layout.axes[0].bottom - layout.axes[static_cast<std::size_t>(columns)].top;
  };
  EXPECT_GT(gap("time", 1), 45);
  EXPECT_GT(gap("time", 2), 45);
  EXPECT_GT(gap("", 1), 5);
  EXPECT_LT(gap("", 1), 25);
}

TEST_F(FigureFile, PngHasTheSizeOfTheLayout) {
  draw_figure(one_curve({"a", {{0, 0}, {1, 1}}}), folder_ / "f.PNG");
  const std::string png = read_file(folder_ / "f.PNG");
  ASSERT_GT(png.size(), 1000u);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  const auto number = [&](std::size_t at) {
    return (static_cast<unsigned char>(png[at]) << 24) +
           (static_cast<unsigned char>(png[at + 1]) << 16) +
           (static_cast<unsigned char>(png[at + 2]) << 8) + static_cast<unsigned char>(png[at + 3]);
  };
  EXPECT_GT(number(16), 600);
  EXPECT_GT(number(20), 300);
}

std::string error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST_F(FigureFile, SaysWhatIsWrong) {
  const Figure figure = one_curve({"a", {{0, 0}, {1, 1}}});
  EXPECT_NE(error_of([&] { draw_figure(figure, folder_ / "f.pdf"); }).find(".svg or .png"),
            std::string::npos);
  EXPECT_NE(error_of([&] { check_figure_file("figure"); }).find(".svg or .png"), std::string::npos);
  EXPECT_EQ(error_of([&] { check_figure_file("figure.svg"); }), "");

  const std::string path = std::getenv("PATH");
  const fs::path target = folder_ / "kept.svg";
  std::ofstream(target) << "old";
  ::setenv("PATH", folder_.c_str(), 1);
  EXPECT_NE(error_of([&] { draw_figure(figure, target); }).find("apt-get install gnuplot-nox"),
            std::string::npos);
  EXPECT_NE(error_of([&] { check_figure_file(target); }).find("gnuplot-nox"), std::string::npos);
  std::ofstream(folder_ / "gnuplot") << "#!/bin/sh\necho line 3: no such thing >&2\nexit 1\n";
  fs::permissions(folder_ / "gnuplot", fs::perms::owner_all);
  EXPECT_NE(error_of([&] { draw_figure(figure, target); }).find("line 3: no such thing"),
            std::string::npos);
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(read_file(target), "old");
}

}  // namespace
}  // namespace taut
