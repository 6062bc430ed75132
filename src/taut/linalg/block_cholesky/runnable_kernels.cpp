#include "taut/linalg/block_cholesky/runnable_kernels.h"

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
std::vector<const FrontKernels<float>*> runnable_front_kernels<float>() {
  std::vector<const FrontKernels<float>*> runnable;
#if defined(__x86_64__)
  if (x86_64_level() >= 4) runnable.push_back(&kernels_x86_64_v4::float_kernels);
  if (x86_64_level() >= 3) runnable.push_back(&kernels_x86_64_v3::float_kernels);
#endif
  runnable.push_back(&kernels_plain::float_kernels);
  return runnable;
}

template <>
std::vector<const FrontKernels<double>*> runnable_front_kernels<double>() {
  std::vector<const FrontKernels<double>*> runnable;
#if defined(__x86_64__)
  if (x86_64_level() >= 4) runnable.push_back(&kernels_x86_64_v4::double_kernels);
  if (x86_64_level() >= 3) runnable.push_back(&kernels_x86_64_v3::double_kernels);
#endif
  runnable.push_back(&kernels_plain::double_kernels);
  return runnable;
}

template <class T>
const FrontKernels<T>& front_kernels() {
  static const FrontKernels<T>& chosen = *runnable_front_kernels<T>().front();
  return chosen;
}

template const FrontKernels<float>& front_kernels<float>();
template const FrontKernels<double>& front_kernels<double>();

}  // namespace taut
