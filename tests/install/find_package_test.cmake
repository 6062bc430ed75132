# Installs the build into an empty folder, then configures, builds and runs a project that knows only that folder.
#   cmake -D BUILD=... -D WORK=... -D GENERATOR=... -D COMPILER=... -D HAS_APP=ON -P find_package_test.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "'${command}' ended with ${code}:\n${output}")
  endif()
  set(output ${output} PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${WORK}/build -G ${GENERATOR} -D CMAKE_CXX_COMPILER=${COMPILER}
    -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${WORK}/prefix)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)
# A 1 m x 1 m grid of 5 x 4 nodes: rows of 5 nodes at heights 0, 1/3, 2/3 and 1.
if(NOT output STREQUAL "nodes 20, triangles 24, sum of heights 10\n")
  message(FATAL_ERROR "the consumer printed: ${output}")
endif()
if(HAS_APP)
  run(${WORK}/prefix/bin/taut --help)
endif()
