#include "mkl_runtime.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <mkl_service.h>

#include <cstdlib>
#include <filesystem>

namespace taut {

namespace {

// oneMKL ends the process when it lacks its OpenMP library, so that is looked for first.
void* open_library(std::string& error) {
  if (!dlopen("libgomp.so.1", RTLD_NOW | RTLD_LOCAL)) {
    error =
        fmt::format("PARDISO needs GCC's OpenMP library (Debian package libgomp1): {}", dlerror());
    return nullptr;
  }
  void* library = dlopen(TAUT_MKL_RT, RTLD_NOW | RTLD_LOCAL);
  if (!library)
    library = dlopen(std::filesystem::path(TAUT_MKL_RT).filename().c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library)
    error = fmt::format("oneMKL, found at {} when this was built, cannot be loaded: {}",
                        TAUT_MKL_RT, dlerror());
  return library;
}

template <class Function>
Function find(void* library, const char* name, std::string& error) {
  const auto function = reinterpret_cast<Function>(dlsym(library, name));
  if (!function) error = fmt::format("{} has no {}", TAUT_MKL_RT, name);
  return function;
}

MklRuntime load() {
  MklRuntime mkl;
  void* library = open_library(mkl.error);
  if (!library) return mkl;
  const auto set_threading_layer =
      find<decltype(&MKL_Set_Threading_Layer)>(library, "MKL_Set_Threading_Layer", mkl.error);
  const auto set_interface_layer =
      find<decltype(&MKL_Set_Interface_Layer)>(library, "MKL_Set_Interface_Layer", mkl.error);
  const auto set_reproducibility =
      find<decltype(&MKL_CBWR_Set)>(library, "MKL_CBWR_Set", mkl.error);
  const auto set_dynamic = find<decltype(&MKL_Set_Dynamic)>(library, "MKL_Set_Dynamic", mkl.error);
  mkl.set_num_threads_local =
      find<decltype(&MKL_Set_Num_Threads_Local)>(library, "MKL_Set_Num_Threads_Local", mkl.error);
  mkl.pardiso = find<decltype(&::pardiso)>(library, "pardiso", mkl.error);
  mkl.pardiso_getdiag = find<decltype(&::pardiso_getdiag)>(library, "pardiso_getdiag", mkl.error);
  if (!mkl.error.empty()) return mkl;
  // In this order, before anything else of oneMKL is called.
  set_threading_layer(MKL_THREADING_GNU);
  set_interface_layer(MKL_INTERFACE_LP64);
  if (!std::getenv("MKL_CBWR")) set_reproducibility(MKL_CBWR_AUTO);
  set_dynamic(0);
  return mkl;
}

}  // namespace

const MklRuntime& mkl_runtime() {
  static const MklRuntime runtime = load();
  return runtime;
}

}  // namespace taut
