# Installs the build into an empty folder, then configures, builds and runs a project that knows
# only that folder.
#   cmake -D BUILD=... -D WORK=... -D GENERATOR=... -D COMPILER=... -D HAS_APP=ON -D HAS_CHOLMOD=ON
#         -D HAS_PARDISO=ON -P find_package_test.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    list(JOIN ARGN " " command)
    message("${output}")
    message(FATAL_ERROR "'${command}' ended with ${code}; its output stands above")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(run_and_expect program expected)
  run(${program})
  if(NOT output STREQUAL expected)
    message(FATAL_ERROR "${program} printed '${output}', expected '${expected}'")
  endif()
endfunction()

function(run_and_match program pattern)
  run(${program} ${ARGN})
  if(NOT output MATCHES "${pattern}")
    message(FATAL_ERROR "${program} printed '${output}', expected '${pattern}'")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${WORK}/build -G ${GENERATOR}
    -D CMAKE_CXX_COMPILER=${COMPILER}
    -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${WORK}/prefix -D EXPECT_CHOLMOD=${HAS_CHOLMOD}
    -D EXPECT_PARDISO=${HAS_PARDISO} -D EXAMPLES=${CMAKE_CURRENT_LIST_DIR}/../../examples)
run(${CMAKE_COMMAND} --build ${WORK}/build)
# A 1 m x 1 m grid of 5 x 4 nodes: rows of 5 nodes at heights 0, 1/3, 2/3 and 1.
run_and_expect(${WORK}/build/consumer "nodes 20, triangles 24, sum of heights 10\n")
if(HAS_CHOLMOD)
  run_and_expect(${WORK}/build/factorise "cholmod: x = 0.5\n")
else()
  run_and_expect(${WORK}/build/factorise "eigen: x = 0.5\n")
endif()
set(examples ${CMAKE_CURRENT_LIST_DIR}/../../examples)
file(STRINGS ${examples}/hang.cpp lines)
list(LENGTH lines count)
if(count GREATER 25)
  message(FATAL_ERROR "examples/hang.cpp has ${count} lines, at most 25 expected")
endif()
run_and_match(${WORK}/build/hang "^after 0.5 s the lowest node is at z = 0.0[78] m\n$")
run_and_match(${WORK}/build/moving_solid "same bits: yes\n$")
run_and_match(${WORK}/build/own_matrix "core_pcg:block +2[0-9] iterations, .* 1e-8: yes")
run_and_match(${WORK}/build/own_preconditioner "^same motion: yes, solves counted: 50\n$")
run_and_match(${WORK}/build/scene "^3 steps of Four corners pinned\n$"
              ${examples}/../scenes/pinned.toml)
if(HAS_APP)
  run(${WORK}/prefix/bin/taut --help)
  if(HAS_CHOLMOD)  # runs a scene that was installed, in a folder that has none
    file(MAKE_DIRECTORY ${WORK}/elsewhere)
    execute_process(COMMAND ${WORK}/prefix/bin/taut bench table2 --nodes 1681 --k-stretch 60
                            --steps 1
                    WORKING_DIRECTORY ${WORK}/elsewhere COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
  endif()
  if(NOT EXISTS ${WORK}/prefix/share/taut/scenes/ball.toml)
    message(FATAL_ERROR "the scenes were not installed")
  endif()
  if(EXISTS ${CMAKE_CURRENT_LIST_DIR}/../../build/viewer/index.html
     AND NOT EXISTS ${WORK}/prefix/share/taut/viewer/index.html)
    message(FATAL_ERROR "the viewer's page has been built, but was not installed")
  endif()
endif()
