#pragma once
// The figures of the paper's Tables 1 and 2 (Ye, Webber & Wang 2009; Intel Core 2 Duo 2.13 GHz, one
// core), for comparison. Seconds a step include assembly. Where the scan of Table 2 has merged
// cells of different k_strh (direct methods do not depend on it) the same figure stands for all.

#include <optional>
#include <span>
#include <string_view>

namespace taut::app {

struct PaperRow {
  std::string_view scene;  // "pinned", "draping", "ball"
  int nodes;
  std::string_view integrator;  // "semi_implicit_euler", "imex"
  int k_stretch;
  std::string_view method;  // "mpcg", "upcg", "cholmod", "pardiso", "pardiso_cgs", "core_pcg"
  std::optional<int> iterations;
  std::optional<double> seconds;  // empty: not legible in the copy at hand
};

std::span<const PaperRow> paper_rows();
const PaperRow* paper_row(std::string_view scene, int nodes, std::string_view integrator,
                          int k_stretch, std::string_view method);

}  // namespace taut::app
