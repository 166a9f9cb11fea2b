# Manual pages, made by help2man where it is installed, and completions, installed where man, bash and zsh look for
# them. A program that was built for another machine cannot be run here: then GDTSLAM_HOST_PROGRAM names one of
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
set(program $<TARGET_FILE:gdtslam>)
if(GDTSLAM_HOST_PROGRAM)
  set(program ${GDTSLAM_HOST_PROGRAM})
endif()

find_program(GDTSLAM_HELP2MAN help2man)
mark_as_advanced(GDTSLAM_HELP2MAN)
set(shell_files ${PROJECT_BINARY_DIR}/shell_files)
set(pages "")
if(GDTSLAM_HELP2MAN)
  get_property(commands GLOBAL PROPERTY GDTSLAM_COMMANDS)
  foreach(command IN LISTS commands ITEMS "")
    list(APPEND pages COMMAND ${PROJECT_SOURCE_DIR}/tools/scripts/man_page.sh ${program}
      ${shell_files}/man1 ${command})
  endforeach()
else()
  message(STATUS "No manual pages: there is no help2man")
endif()
add_custom_command(OUTPUT ${shell_files}/made
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${shell_files}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${shell_files}/man1
  ${pages}
  COMMAND ${program} generate completion bash > ${shell_files}/gdtslam
  COMMAND ${program} generate completion zsh > ${shell_files}/_gdtslam
  COMMAND ${CMAKE_COMMAND} -E touch ${shell_files}/made
  DEPENDS gdtslam ${PROJECT_SOURCE_DIR}/tools/scripts/man_page.sh VERBATIM COMMENT "Manual pages and completions")
add_custom_target(gdtslam_shell_files ALL DEPENDS ${shell_files}/made)

# Optional: whoever builds the program alone can install it alone.
install(DIRECTORY ${shell_files}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT tools OPTIONAL)
install(FILES ${shell_files}/gdtslam DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  COMPONENT tools OPTIONAL)
install(FILES ${shell_files}/_gdtslam DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
  COMPONENT tools OPTIONAL)
