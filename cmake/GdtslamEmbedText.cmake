# gdtslam_embed_text(TARGET NAMESPACE NAME=FILE[,FILE...]...): gives TARGET a source that defines, in that namespace, the
# function std::string_view NAME() with the text of the files, one after the other. Built anew when one of them changes.
#
# Run as a script (-P) with INPUTS (joined by ","), NAME, NAMESPACE and OUTPUT it writes one such source.
if(CMAKE_SCRIPT_MODE_FILE)
  string(REPLACE "," ";" inputs "${INPUTS}")
  set(pieces "")
  foreach(input IN LISTS inputs)
    file(READ ${input} text)
    string(FIND "${text}" ")embedded\"" end)
    if(NOT end EQUAL -1)
      message(FATAL_ERROR "${input} holds the mark that ends an embedded text")
    endif()
    string(APPEND pieces "R\"embedded(${text})embedded\"\n")
  endforeach()
  file(WRITE ${OUTPUT} "// Made by cmake/GdtslamEmbedText.cmake.\n#include <string_view>\n\nnamespace ${NAMESPACE} {\n"
    "std::string_view ${NAME}();\nstd::string_view ${NAME}() {\n  return ${pieces};\n}\n}  // namespace ${NAMESPACE}\n")
  return()
endif()

set(GDTSLAM_EMBED_TEXT_SCRIPT ${CMAKE_CURRENT_LIST_FILE})
function(gdtslam_embed_text target namespace)
  foreach(entry IN LISTS ARGN)
    string(REGEX MATCH "^([a-z_]+)=(.+)$" is_entry "${entry}")
    set(name ${CMAKE_MATCH_1})
    string(REPLACE "," ";" inputs "${CMAKE_MATCH_2}")
    list(TRANSFORM inputs PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
    list(JOIN inputs "," joined)
    set(output ${CMAKE_CURRENT_BINARY_DIR}/embedded/${name}.cpp)
    add_custom_command(OUTPUT ${output}
      COMMAND ${CMAKE_COMMAND} -DINPUTS=${joined} -DNAME=${name} -DNAMESPACE=${namespace} -DOUTPUT=${output}
        -P ${GDTSLAM_EMBED_TEXT_SCRIPT}
      DEPENDS ${inputs} ${GDTSLAM_EMBED_TEXT_SCRIPT} COMMENT "Text ${name}" VERBATIM)
    target_sources(${target} PRIVATE ${output})
  endforeach()
endfunction()
