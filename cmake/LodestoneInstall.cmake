# Installs the modules and a package, so that find_package(lodestone CONFIG) gives lodestone::core, lod and io.

include(CMakePackageConfigHelpers)

get_property(modules GLOBAL PROPERTY LODESTONE_MODULES)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/lodestone)

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
