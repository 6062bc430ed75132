#pragma once
// TAUT_MULTIVERSION in front of a free function compiles it for several instruction sets; the
// loader picks the best one the machine has. Inside such a function,
// `#pragma omp simd reduction(+ : s)` allows a vectorised sum. The result depends on the
// instruction set (recorded by runs in summary.json), never on the number of threads. Sanitizers
// cannot run before the loader resolves these, so they get the plain version.

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TAUT_MULTIVERSION                                                      \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), \
                 optimize("fp-contract=fast")))
// The same without AVX-512, where GCC 12 fails on comparisons of eight floats
// ("internal compiler error").
#define TAUT_MULTIVERSION_AVX2 \
  __attribute__((target_clones("arch=x86-64-v3", "default"), optimize("fp-contract=fast")))
#else
#define TAUT_MULTIVERSION
#define TAUT_MULTIVERSION_AVX2
#endif

// For what such a function calls: compiled with it, for its instruction set.
#if defined(__GNUC__)
#define TAUT_ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define TAUT_ALWAYS_INLINE inline
#endif

namespace taut {

// "x86-64-v4", "x86-64-v3" or "default": what TAUT_MULTIVERSION functions
// resolve to on this machine.
const char* instruction_set();

// What the processor can run: 4 (AVX-512), 3 (AVX2 and FMA), or 0 for less and for other
// architectures. For kernels that are compiled once per instruction set in sources of their own and
// chosen by a table.
int x86_64_level();

}  // namespace taut
