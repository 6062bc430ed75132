#pragma once
// All that a program needs to simulate cloth, and to solve matrices as Taut does (docs/library.md).
// Scene files and results are the component `scenes`: taut/scene/scene_simulation.h,
// taut/results/run.h.

#include "taut/base/error.h"
#include "taut/base/parallel.h"
#include "taut/linalg/block_cholesky.h"
#include "taut/linalg/block_csr.h"
#include "taut/linalg/pcg.h"
#include "taut/linalg/preconditioner.h"
#include "taut/mesh/grid.h"
#include "taut/mesh/triangle_mesh.h"
#include "taut/mesh/tube.h"
#include "taut/sim/simulation.h"
#include "taut/sim/validator.h"
#include "taut/sim/world.h"
#include "taut/solve/linear_system.h"
#include "taut/solve/solver.h"
#include "taut/solve/solver_registry.h"
