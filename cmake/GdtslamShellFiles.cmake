# Manual pages and completions, made by the program itself when it is built and installed where man, bash, zsh and fish
# look for them. A program that was built for another machine cannot be run here: then GDTSLAM_HOST_PROGRAM names one of
# the same sources that can, and without it there are none.
set(GDTSLAM_HOST_PROGRAM "" CACHE FILEPATH
  "A gdtslam of these sources that runs on this machine, to make manual pages and completions when cross-compiling")
if(NOT TARGET gdtslam)
  return()
endif()
if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR AND NOT GDTSLAM_HOST_PROGRAM)
  message(STATUS "No manual pages and completions: -DGDTSLAM_HOST_PROGRAM=FILE names a gdtslam that runs here")
  return()
endif()
if(GDTSLAM_SANITIZE)
  return()
endif()
set(program gdtslam)
if(GDTSLAM_HOST_PROGRAM)
  set(program ${GDTSLAM_HOST_PROGRAM})
endif()

set(shell_files ${PROJECT_BINARY_DIR}/shell_files)
add_custom_command(OUTPUT ${shell_files}/made
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${shell_files}
  COMMAND ${program} generate man -o ${shell_files}/man
  COMMAND ${program} generate completion bash -o ${shell_files}/gdtslam
  COMMAND ${program} generate completion zsh -o ${shell_files}/_gdtslam
  COMMAND ${program} generate completion fish -o ${shell_files}/gdtslam.fish
  COMMAND ${CMAKE_COMMAND} -E touch ${shell_files}/made
  DEPENDS gdtslam VERBATIM COMMENT "Manual pages and completions")
add_custom_target(gdtslam_shell_files ALL DEPENDS ${shell_files}/made)

# Optional: whoever builds the program alone can install it alone.
install(DIRECTORY ${shell_files}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT tools OPTIONAL)
install(FILES ${shell_files}/gdtslam DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  COMPONENT tools OPTIONAL)
install(FILES ${shell_files}/_gdtslam DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
  COMPONENT tools OPTIONAL)
install(FILES ${shell_files}/gdtslam.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
  COMPONENT tools OPTIONAL)
