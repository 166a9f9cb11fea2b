# Writes TARGET, the source that says which commit the program was built from: COMMIT, else that of the git clone SOURCE,
# else 'unknown'. The file is touched only when that changes, so that a build without a new commit compiles nothing.
set(commit "${COMMIT}")
set(date "")
find_package(Git QUIET)
if(Git_FOUND AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} log -1 --format=%h\ %cs --abbrev=12
    OUTPUT_VARIABLE line OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed AND NOT commit AND line MATCHES "^([0-9a-f]+) ([0-9-]+)$")
    set(commit ${CMAKE_MATCH_1})
    set(date ${CMAKE_MATCH_2})
    execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} diff --quiet HEAD --
      RESULT_VARIABLE changed ERROR_QUIET)
    if(changed)
      string(APPEND commit ", changed")
    endif()
  endif()
endif()
if(NOT commit)
  set(commit unknown)
endif()

set(text "// Made by cmake/GdtslamStamp.cmake: what the program was built from.
#include \"tools/gdtslam/shell/commands.hpp\"

namespace gdtslam {

BuildStamp build_stamp() { return {\"${commit}\", \"${date}\"}; }

}  // namespace gdtslam
")
set(old "")
if(EXISTS ${TARGET})
  file(READ ${TARGET} old)
endif()
if(NOT text STREQUAL old)
  file(WRITE ${TARGET} "${text}")
endif()
