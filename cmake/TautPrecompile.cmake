# Precompiled headers: they save a third of the time. The release build has them for tests only, so
# that a source that forgets an include does not compile.
#   taut_precompile(TARGET FAMILY HEADERS...)   the first target of a family compiles the headers,
#                                               the others reuse them
function(taut_precompile target family)
  if(NOT TAUT_SANITIZE AND NOT family STREQUAL tests)
    return()
  endif()
  get_property(first GLOBAL PROPERTY TAUT_PRECOMPILED_${family})
  if(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    set_property(GLOBAL PROPERTY TAUT_PRECOMPILED_${family} ${target})
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()
