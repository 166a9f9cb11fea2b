# The target `bundle`: one relocatable folder with the command, the sample log and the licences of what is inside, and the
# same as .tar.gz, in the folder bundle/ of the build tree. It runs on every Linux of this processor whose C library is not
# older than the one built with; a GPU is used through the driver that the machine has.
if(NOT GDTSLAM_STATIC OR NOT TARGET gdtslam)
  return()
endif()
string(TOLOWER "${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}" platform)
set(GDTSLAM_BUNDLE_NAME gdtslam-${PROJECT_VERSION}-${platform})
list(JOIN GDTSLAM_STATIC_INPUTS "\n" inputs)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/bundle_inputs.txt CONTENT "@inputs@\n" @ONLY)
add_custom_target(bundle
  COMMAND ${PROJECT_SOURCE_DIR}/tools/scripts/make_bundle.sh ${PROJECT_BINARY_DIR} ${GDTSLAM_BUNDLE_NAME}
    "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
  DEPENDS gdtslam USES_TERMINAL VERBATIM
  COMMENT "Bundle ${GDTSLAM_BUNDLE_NAME}")
if(TARGET gdtslam_shell_files)
  add_dependencies(bundle gdtslam_shell_files)
endif()
