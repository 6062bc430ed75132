#pragma once
// The choice among the compiled kernels (front_kernels.h, which the kernels themselves include and
// which must stay free of library code).

#include <vector>

#include "taut/linalg/block_cholesky/front_kernels.h"

namespace taut {

// All that this machine can run: x86-64-v4, x86-64-v3, plain. The plain ones are
// always there and come last.
template <class T>
std::vector<const FrontKernels<T>*> runnable_front_kernels();

// The first of them, chosen once.
template <class T>
const FrontKernels<T>& front_kernels();

}  // namespace taut
