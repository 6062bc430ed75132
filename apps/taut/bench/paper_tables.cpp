#include "bench/paper_tables.h"

namespace taut::app {

namespace {

constexpr std::string_view semi = "semi_implicit_euler", imex = "imex";

const PaperRow published[] = {
    // Table 1: 6,561 nodes, 3.67 ms.
    {"pinned", 6561, semi, 60, "mpcg", 35, 0.25},
    {"pinned", 6561, semi, 60, "upcg", 35, 0.22},
    {"pinned", 6561, semi, 600, "mpcg", 116, 0.65},
    {"pinned", 6561, semi, 600, "upcg", 115, 0.50},
    {"pinned", 6561, semi, 6000, "mpcg", 413, 2.03},
    {"pinned", 6561, semi, 6000, "upcg", 414, 1.53},
    {"draping", 6561, semi, 60, "mpcg", 26, 0.23},
    {"draping", 6561, semi, 60, "upcg", 24, 0.11},
    {"draping", 6561, semi, 600, "mpcg", 78, 0.49},
    {"draping", 6561, semi, 600, "upcg", 77, 0.17},
    {"draping", 6561, semi, 6000, "mpcg", 267, 1.54},
    {"draping", 6561, semi, 6000, "upcg", 270, 0.42},
    // Table 2: iterative methods, a row for each k_strh.
    {"ball", 1681, semi, 60, "mpcg", 119, 0.16},
    {"ball", 1681, semi, 600, "mpcg", 314, 0.38},
    {"ball", 1681, semi, 6000, "mpcg", 722, 0.84},
    {"ball", 1681, imex, 60, "mpcg", 131, 0.10},
    {"ball", 1681, imex, 600, "mpcg", 305, 0.22},
    {"ball", 1681, imex, 6000, "mpcg", 681, 0.46},
    {"ball", 6561, semi, 60, "mpcg", 50, 0.32},
    {"ball", 6561, semi, 600, "mpcg", 123, 0.66},
    {"ball", 6561, semi, 6000, "mpcg", 511, 2.43},
    {"ball", 6561, imex, 60, "mpcg", 53, 0.21},
    {"ball", 6561, imex, 600, "mpcg", 114, 0.36},
    {"ball", 6561, imex, 6000, "mpcg", 442, 1.22},
    {"ball", 25921, semi, 60, "mpcg", 88, 2.24},
    {"ball", 25921, semi, 600, "mpcg", 256, 5.77},
    {"ball", 25921, semi, 6000, "mpcg", 574, 12.42},
    {"ball", 25921, imex, 60, "mpcg", 88, 1.32},
    {"ball", 25921, imex, 600, "mpcg", 258, 3.35},
    {"ball", 25921, imex, 6000, "mpcg", 575, 7.22},
    {"ball", 1681, semi, 60, "core_pcg", 2, 0.07},
    {"ball", 1681, semi, 600, "core_pcg", 4, 0.07},
    {"ball", 1681, semi, 6000, "core_pcg", 3, {}},
    {"ball", 6561, semi, 60, "core_pcg", 3, 0.35},
    {"ball", 6561, semi, 600, "core_pcg", 4, 0.35},
    {"ball", 6561, semi, 6000, "core_pcg", 5, {}},
    {"ball", 25921, semi, 60, "core_pcg", 4, 1.79},
    {"ball", 25921, semi, 600, "core_pcg", 4, 1.81},
    {"ball", 25921, semi, 6000, "core_pcg", 4, {}},
    // Direct methods: one figure for all stiffnesses (k_stretch 0 here).
    {"ball", 1681, semi, 0, "cholmod", {}, 0.11},
    {"ball", 1681, semi, 0, "pardiso", {}, 0.15},
    {"ball", 1681, semi, 0, "pardiso_cgs", {}, 0.15},
    {"ball", 1681, imex, 0, "cholmod", {}, 0.05},
    {"ball", 1681, imex, 0, "pardiso", {}, 0.06},
    {"ball", 6561, semi, 0, "cholmod", {}, 0.65},
    {"ball", 6561, semi, 0, "pardiso", {}, 0.78},
    {"ball", 6561, semi, 0, "pardiso_cgs", {}, 0.76},
    {"ball", 6561, imex, 0, "cholmod", {}, 0.23},
    {"ball", 6561, imex, 0, "pardiso", {}, 0.29},
    {"ball", 25921, semi, 0, "cholmod", {}, 3.88},
    {"ball", 25921, semi, 0, "pardiso", {}, 4.29},
    {"ball", 25921, semi, 0, "pardiso_cgs", {}, 4.40},
    {"ball", 25921, imex, 0, "cholmod", {}, 1.16},
    {"ball", 25921, imex, 0, "pardiso", {}, 1.42},
};

}  // namespace

std::span<const PaperRow> paper_rows() { return published; }

const PaperRow* paper_row(std::string_view scene, int nodes, std::string_view integrator,
                          int k_stretch, std::string_view method) {
  for (const PaperRow& row : published)
    if (row.scene == scene && row.nodes == nodes && row.integrator == integrator &&
        (row.k_stretch == k_stretch || row.k_stretch == 0) && row.method == method)
      return &row;
  return nullptr;
}

}  // namespace taut::app
