#pragma once
// Before one method is timed after another: threads of other libraries (OpenBLAS, OpenMP) look for
// work for a while after a solve, some 25 ms, and share the processors with whatever comes next.
// This multiplies until they sleep: processors stay awake and the matrix is in the caches as after
// assembly. With one thread nothing happens.

#include "taut/linalg/block_csr.h"

namespace taut::app {

void wait_for_quiet(const BlockCsr& a);

}  // namespace taut::app
