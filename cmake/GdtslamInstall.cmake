# Installs the package description, so that find_package(gdtslam COMPONENTS ...) works from an install prefix. Each part
# has its own targets file; a part's packages are looked for only when the part is asked for.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/gdtslam)
get_property(components GLOBAL PROPERTY GDTSLAM_COMPONENTS)
foreach(component IN LISTS components)
  install(EXPORT gdtslam_${component}_targets NAMESPACE gdtslam:: DESTINATION ${package_dir}
    FILE gdtslam-${component}-targets.cmake COMPONENT ${component})
endforeach()

list(JOIN components " " GDTSLAM_INSTALLED_COMPONENTS)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/gdtslamConfig.cmake.in
  ${PROJECT_BINARY_DIR}/gdtslamConfig.cmake INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO
  NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/gdtslamConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/gdtslamConfig.cmake ${PROJECT_BINARY_DIR}/gdtslamConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT core)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT core)
if(GDTSLAM_BUILD_TOOLS) # the sample scenes and what verify compares with, which the command finds beside itself
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/assets/ DESTINATION ${CMAKE_INSTALL_DATADIR}/gdtslam COMPONENT tools)
endif()
