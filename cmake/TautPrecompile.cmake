# Precompiled headers, for tests only: a source of Taut that forgets an include must not compile.
#   taut_precompile(TARGET FAMILY HEADERS...)   the first target of a family compiles the headers,
#                                               the others reuse them
function(taut_precompile target family)
  if(TAUT_CCACHE)
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
  endif()
  get_property(first GLOBAL PROPERTY TAUT_PRECOMPILED_${family})
  if(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    set_property(GLOBAL PROPERTY TAUT_PRECOMPILED_${family} ${target})
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()
