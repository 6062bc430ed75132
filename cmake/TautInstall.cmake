# cmake --install: the headers that a user needs, the libraries, the program, and what
# find_package(taut) reads. taut::taut stands alone; files, pictures and scenes are the component
# `scenes`. taut_cholmod is a component, so that nobody links GPL code who did not ask for it;
# taut_pardiso likewise.
include(CMakePackageConfigHelpers)
set(taut_cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/taut)

get_property(headers GLOBAL PROPERTY TAUT_PUBLIC_HEADERS)
foreach(header IN LISTS headers)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${CMAKE_SOURCE_DIR}/src/taut/${header}
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/taut/${folder})
endforeach()
install(TARGETS taut EXPORT tautTargets)
install(EXPORT tautTargets NAMESPACE taut:: DESTINATION ${taut_cmake_folder})
install(TARGETS taut_files taut_pictures taut_scenes EXPORT tautScenesTargets)
install(EXPORT tautScenesTargets NAMESPACE taut:: FILE tautScenesTargets.cmake
        DESTINATION ${taut_cmake_folder})
if(TARGET taut_app)
  install(TARGETS taut_app)
  # The benches run them.
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/taut)
  # The page of `taut view`, if npm has built it: ./taut view or `npm run build` in viewer/.
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/build/viewer/
          DESTINATION ${CMAKE_INSTALL_DATADIR}/taut/viewer OPTIONAL)
endif()

if(TARGET taut_cholmod)
  set_target_properties(taut_cholmod PROPERTIES EXPORT_NAME cholmod)
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/src/taut_cholmod/taut_cholmod
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
  install(TARGETS taut_cholmod EXPORT tautCholmodTargets)
  install(EXPORT tautCholmodTargets NAMESPACE taut:: FILE tautCholmodTargets.cmake
          DESTINATION ${taut_cmake_folder})
endif()

if(TARGET taut_pardiso)
  set_target_properties(taut_pardiso PROPERTIES EXPORT_NAME pardiso)
  install(FILES ${CMAKE_SOURCE_DIR}/src/taut_pardiso/taut_pardiso/pardiso.h
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/taut_pardiso)
  install(TARGETS taut_pardiso EXPORT tautPardisoTargets)
  install(EXPORT tautPardisoTargets NAMESPACE taut:: FILE tautPardisoTargets.cmake
          DESTINATION ${taut_cmake_folder})
endif()

# A static libtaut leaves its private libraries for the consumer to link; a shared one has linked
# them itself.
get_target_property(taut_type taut TYPE)
string(COMPARE EQUAL ${taut_type} STATIC_LIBRARY taut_is_static)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/tautConfig.cmake.in
                              ${CMAKE_BINARY_DIR}/tautConfig.cmake
                              INSTALL_DESTINATION ${taut_cmake_folder})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/tautConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/tautConfig.cmake ${CMAKE_BINARY_DIR}/tautConfigVersion.cmake
        DESTINATION ${taut_cmake_folder})
