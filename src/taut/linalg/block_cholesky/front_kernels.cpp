#include "taut/linalg/block_cholesky/front_kernels.h"

#include "taut/base/simd.h"

namespace taut {

#define TAUT_DECLARE_KERNELS(name)                  \
  namespace name {                                  \
  extern const FrontKernels<float> float_kernels;   \
  extern const FrontKernels<double> double_kernels; \
  }
TAUT_DECLARE_KERNELS(kernels_plain)
#if defined(__x86_64__)
TAUT_DECLARE_KERNELS(kernels_x86_64_v3)
TAUT_DECLARE_KERNELS(kernels_x86_64_v4)
#endif

template <>
const FrontKernels<float>& front_kernels<float>() {
#if defined(__x86_64__)
  if (x86_64_level() >= 4) return kernels_x86_64_v4::float_kernels;
  if (x86_64_level() >= 3) return kernels_x86_64_v3::float_kernels;
#endif
  return kernels_plain::float_kernels;
}

template <>
const FrontKernels<double>& front_kernels<double>() {
#if defined(__x86_64__)
  if (x86_64_level() >= 4) return kernels_x86_64_v4::double_kernels;
  if (x86_64_level() >= 3) return kernels_x86_64_v3::double_kernels;
#endif
  return kernels_plain::double_kernels;
}

}  // namespace taut
