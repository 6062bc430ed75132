#pragma once
// The figure of `taut solve --plot`: how fast each method comes near the answer.

#include "solve/measure_solvers.h"
#include "taut/plot/figure.h"

namespace taut::app {

// A-norm error (without a reference: true residual) against time; a curve a method, a direct method
// is a point.
Figure solve_figure(const std::vector<SolverRow>& rows, const std::vector<HistoryPoint>& histories,
                    const std::string& title);

}  // namespace taut::app
