#if defined(__x86_64__)
#define TAUT_KERNELS kernels_x86_64_v3
#define TAUT_KERNELS_NAME "x86-64-v3"
#include "taut/linalg/block_cholesky/front_kernels.inl"
#endif
