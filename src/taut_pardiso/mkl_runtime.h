#pragma once
// oneMKL, loaded when it is first needed.
//
// It is not linked, because its libraries also define BLAS and LAPACK: in a program that links
// CHOLMOD too, the dynamic linker would give CHOLMOD Intel's dgemm_ in place of its own, and no
// comparison of the two would be one. libmkl_rt, loaded with RTLD_LOCAL, keeps its names to itself.
//
// Settings: GNU OpenMP threads (libgomp is there wherever GCC is), 32-bit integers, and conditional
// numerical reproducibility (MKL_CBWR_AUTO), with which PARDISO gives the same bits for any number
// of threads. The environment variable MKL_CBWR, when set, decides instead: MKL_CBWR=OFF is faster.

#include <mkl_pardiso.h>

#include <string>

namespace taut {

struct MklRuntime {
  std::string error;  // not empty: oneMKL cannot be used, and why
  decltype(&::pardiso) pardiso = nullptr;
  decltype(&::pardiso_getdiag) pardiso_getdiag = nullptr;
  int (*set_num_threads_local)(int) = nullptr;  // of the calling thread; returns what held before
};

const MklRuntime& mkl_runtime();

}  // namespace taut
