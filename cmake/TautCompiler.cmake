# Flags every Taut target compiles with. No -march: instruction sets are chosen at run time
# (base/simd.h).
add_library(taut_compile_options INTERFACE)
target_compile_options(taut_compile_options INTERFACE
  $<$<CXX_COMPILER_ID:GNU,Clang>:-Wall;-Wextra;-Wshadow;-Wnon-virtual-dtor;-fopenmp-simd>
  # No silent a*b+c -> fma outside the multiversioned kernels: the same bits whatever the optimiser
  # feels like.
  $<$<CXX_COMPILER_ID:GNU,Clang>:-ffp-contract=off;-fno-math-errno>)

if(TAUT_SANITIZE STREQUAL "address")
  # Null and misaligned accesses fault or are seen by the address sanitizer; checking each for them
  # doubles the time to compile Eigen's expressions.
  set(taut_sanitizers -fsanitize=address,undefined -fno-sanitize=null,alignment,object-size
      -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
elseif(TAUT_SANITIZE STREQUAL "thread")
  set(taut_sanitizers -fsanitize=thread -fno-omit-frame-pointer)
elseif(TAUT_SANITIZE)
  message(FATAL_ERROR "TAUT_SANITIZE is '${TAUT_SANITIZE}': use address, thread, or leave it empty")
endif()
if(taut_sanitizers)
  target_compile_options(taut_compile_options INTERFACE ${taut_sanitizers} -O1 -g1)
  target_link_options(taut_compile_options INTERFACE ${taut_sanitizers})
endif()

find_program(TAUT_CCACHE ccache)
if(TAUT_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Without these ccache leaves sources with precompiled headers alone (TautPrecompile.cmake).
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
      CCACHE_SLOPPINESS=pch_defines,time_macros ${TAUT_CCACHE})
endif()
