# Installs the libraries, their headers, a CMake package (find_package(lodestone CONFIG) gives lodestone::core and so on) and
# three for pkg-config: lodestone, lodestone-stream for what only draws from streams, and lodestone-c for that in C.

include(CMakePackageConfigHelpers)

get_property(modules GLOBAL PROPERTY LODESTONE_MODULES)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/lodestone)

foreach(folder core lod io tools)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endforeach()
install(TARGETS ${modules} EXPORT lodestoneTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT lodestoneTargets NAMESPACE lodestone:: DESTINATION ${package_dir})

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/lodestoneConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/lodestoneConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
# Before 1.0, a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lodestoneConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lodestoneConfig.cmake ${PROJECT_BINARY_DIR}/lodestoneConfigVersion.cmake
        DESTINATION ${package_dir})

# lodestone_pkg_config(NAME "what it is" MODULES lodestone_b lodestone_a PACKAGES zstd … LIBRARIES -lother …): modules with those
# that they use after them. What shared libraries link themselves, users of static ones link, too.
function(lodestone_pkg_config name description)
  cmake_parse_arguments(ARG "" "" "MODULES;PACKAGES;LIBRARIES" ${ARGN})
  set(PC_NAME ${name})
  set(PC_DESCRIPTION ${description})
  list(TRANSFORM ARG_MODULES PREPEND -l)
  if(BUILD_SHARED_LIBS)
    set(PC_PRIVATE .private)
    list(JOIN ARG_LIBRARIES " " PC_PRIVATE_LIBS)
  else()
    list(APPEND ARG_MODULES ${ARG_LIBRARIES})
  endif()
  list(JOIN ARG_MODULES " " PC_LIBS)
  list(JOIN ARG_PACKAGES " " PC_PACKAGES)
  file(RELATIVE_PATH PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/lodestone.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

if(NOT LODESTONE_RUNTIME_ONLY)
  set(linked ${modules})
  list(REVERSE linked)
  list(REMOVE_ITEM linked lodestone_lod lodestone_c)  # a group: nothing of its own to link; for programs in C
  lodestone_pkg_config(lodestone "${PROJECT_DESCRIPTION}"
    MODULES ${linked}
    PACKAGES libzstd draco assimp geos tbb
    LIBRARIES -lmeshoptimizer)
endif()
lodestone_pkg_config(lodestone-stream "Draws from lodestone's removal streams"
  MODULES lodestone_stream lodestone_progressive lodestone_core
  PACKAGES libzstd)
lodestone_pkg_config(lodestone-c "Draws from lodestone's streams, in C"
  MODULES lodestone_c)
