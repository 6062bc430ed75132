#pragma once
// `taut dump`: the linear system of one step as files that any tool reads (docs/dump.md).
//
//   A.mtx, A_core.mtx           kg; symmetric. A_core: the diagonal 3x3 blocks of A and those
//                               off-diagonal blocks that a stretch spring
//   fills K_stretch, K_shear, K_bend  N/m; symmetric, the used stiffness of all springs of a class,
//                                     whether or not the integrator is
//   implicit in them D_external.mtx              kg/s; symmetric, drag and wind; absent if there is
//                                                neither S.mtx, U.mtx general, 3N x 3N
//   and 3N x n; columns of U: the free directions of node 0, then of node 1, ... M b z x v f dv
//   .mtx         3N x 1, x0 y0 z0 x1 ...: masses (kg), right-hand side as solved, prescribed part
//                of the unknown, state at the start of the
//                               step (m, m/s), force there (N: springs with damping, and external),
//                               the unknown
//   x_prev.mtx, v_prev.mtx      BDF2 with a step behind it
//   guess.mtx                   what iterative solvers started from (before S guess + (I-S) z);
//                               absent: 0
//   friction.mtx                N s, impulses of sliding friction that are part of b; absent if
//                               there are none
//   springs.csv                 i,j,class,rest_length,stiffness,damping; nodes from 0
//   meta.json                   step size, integrator, conventions, solver, what it reported;
//                               written last: without it a dump is not
//   complete
//
// With c_f, c_K, c_D, c_j the integrator's coefficients (step/integrator.h): A = M + c_D
// (D_external + D_springs) + c_K (K_stretch + K_shear + K_bend), imex: springs of K_stretch only,
// imex_adaptive: those marked implicit in springs.csv; b has c_j friction in it (c_j = 1 for an
// unknown dv, 4h/9 for dx).

#include <filesystem>
#include <functional>

#include "taut/scene/scene_simulation.h"
#include "taut/solve/linear_system.h"

namespace taut {

// Makes the folder ready: files of an earlier dump are removed. Throws InputError when it holds
// anything else.
void prepare_dump(const std::filesystem::path& folder);

// Writes the system that `simulation` has just solved: to be called from
// SceneSimulation::on_solved. Step numbers count from 1.
void write_dump(const std::filesystem::path& folder, SceneSimulation& simulation,
                const SolveSummary& summary);

struct DumpOutcome {
  Status status;  // not ok: an earlier step, or this one, could not be solved; nothing was written
  SolveSummary summary;
};

// Runs the scene to step `step` (from 1) and writes the system of its last contact pass. `on_step`
// is told about every step and may be empty.
DumpOutcome dump_step(SceneSimulation& simulation, int step, const std::filesystem::path& folder,
                      const std::function<void(const StepReport&)>& on_step = {});

}  // namespace taut
