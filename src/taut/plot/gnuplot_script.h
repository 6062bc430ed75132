#pragma once
// A figure in gnuplot's language. Text from outside stands in single quotes only, where gnuplot
// neither substitutes nor escapes anything but a doubled quote, and the terminals are told to take
// it without markup.

#include "taut/plot/figure.h"

namespace taut {

struct PlotFile {
  std::string name, content;
};

struct GnuplotJob {
  // reads the files and writes `output`, all in the folder where gnuplot is started
  std::string script;
  std::vector<PlotFile> files;
  std::string output;
};

GnuplotJob gnuplot_job(const Figure& figure, bool svg);

// 'text' with quotes doubled and control characters turned into spaces.
std::string gnuplot_string(const std::string& text);

}  // namespace taut
