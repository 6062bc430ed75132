#define TAUT_KERNELS kernels_plain
#define TAUT_KERNELS_NAME "plain"
#include "taut/linalg/block_cholesky/front_kernels.inl"
