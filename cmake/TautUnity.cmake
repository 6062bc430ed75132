# With TAUT_UNITY, as ./taut builds, a target's sources are compiled some at a time: headers that
# each would read by itself are read once for all of them, and the whole is built in less than half
# the time. Without it, which is the default, a changed source is compiled alone; and one that
# forgets an include is found out (preset debug).
#
# Names in unnamed namespaces must then differ within a target. Functions for several instruction
# sets (base/simd.h) stay alone: what the compiler could inline into them would be computed with
# other roundings. So do sources with compile options of their own.
option(TAUT_UNITY
  "Compile several sources at a time: faster from scratch, slower after a change" OFF)

function(taut_unity target)
  if(NOT TAUT_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  # Between sources these say nothing (the first), or are false alarms of GCC 12.
  target_compile_options(${target} PRIVATE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage;-Wno-restrict>)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    file(STRINGS ${source} clones REGEX "^ *TAUT_MULTIVERSION" LIMIT_COUNT 1)
    if(clones)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
endfunction()
