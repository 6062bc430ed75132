# A room is one folder of src/taut: an object library that may include only the rooms it names.
#   taut_room(NAME ROOMS base linalg LIBRARIES Eigen3::Eigen PRIVATE_LIBRARIES PkgConfig::cairo
#             PRIVATE_HEADERS cairo_canvas.h)
# PRIVATE_HEADERS are those that include a header of a private library, or another private header:
# they are not installed.
# libtaut is made of all rooms; a test program of a room links only that room and those below it.
function(taut_room name)
  cmake_parse_arguments(arg "" "" "ROOMS;LIBRARIES;PRIVATE_LIBRARIES;PRIVATE_HEADERS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp
       ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*/*.cpp)
  set(all_rooms ${name})
  set(all_libraries ${arg_LIBRARIES} ${arg_PRIVATE_LIBRARIES})
  foreach(room IN LISTS arg_ROOMS)
    get_property(rooms_below GLOBAL PROPERTY TAUT_ROOMS_OF_${room})
    get_property(libraries_below GLOBAL PROPERTY TAUT_LIBRARIES_OF_${room})
    list(APPEND all_rooms ${rooms_below})
    list(APPEND all_libraries ${libraries_below})
  endforeach()
  list(REMOVE_DUPLICATES all_rooms)
  list(REMOVE_DUPLICATES all_libraries)
  set_property(GLOBAL PROPERTY TAUT_ROOMS_OF_${name} ${all_rooms})
  set_property(GLOBAL PROPERTY TAUT_LIBRARIES_OF_${name} ${all_libraries})
  set_property(GLOBAL APPEND PROPERTY TAUT_ROOMS ${name})
  set_property(GLOBAL APPEND PROPERTY TAUT_PUBLIC_LIBRARIES ${arg_LIBRARIES})
  set_property(GLOBAL APPEND PROPERTY TAUT_PRIVATE_LIBRARIES ${arg_PRIVATE_LIBRARIES})
  list(TRANSFORM arg_PRIVATE_HEADERS PREPEND ${name}/)
  set_property(GLOBAL APPEND PROPERTY TAUT_PRIVATE_HEADERS ${arg_PRIVATE_HEADERS})
  if(NOT sources)
    set(sources ${CMAKE_SOURCE_DIR}/cmake/empty.cpp)
  endif()
  add_library(taut_room_${name} OBJECT ${sources})
  target_include_directories(taut_room_${name} PUBLIC ${CMAKE_SOURCE_DIR}/src)
  target_link_libraries(taut_room_${name} PRIVATE taut_compile_options ${all_libraries})
  taut_precompile(taut_room_${name} rooms <Eigen/Geometry> <fmt/format.h> <algorithm> <functional>
                  <memory> <span> <string> <vector>)
  target_compile_definitions(taut_room_${name} PRIVATE TAUT_VERSION="${PROJECT_VERSION}")
endfunction()

# Links a target to a room and everything below it, without the rest of libtaut.
function(taut_link_room target name)
  get_property(rooms GLOBAL PROPERTY TAUT_ROOMS_OF_${name})
  get_property(libraries GLOBAL PROPERTY TAUT_LIBRARIES_OF_${name})
  foreach(room IN LISTS rooms)
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:taut_room_${room}>)
  endforeach()
  target_include_directories(${target} PRIVATE ${CMAKE_SOURCE_DIR}/src)
  target_link_libraries(${target} PRIVATE taut_compile_options ${libraries})
endfunction()
