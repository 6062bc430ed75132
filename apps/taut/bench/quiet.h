#pragma once
// Before one method is timed after another: threads of other libraries (OpenBLAS, OpenMP) look for work for a while after a solve, some 25 ms, and
// share the processors with whatever comes next. This waits until they sleep and then wakes Taut's own, with a product, as assembly does in a step.
// With one thread nothing happens.

#include "taut/linalg/block_csr.h"

namespace taut::app {

void wait_for_quiet(const BlockCsr& a);

}  // namespace taut::app
