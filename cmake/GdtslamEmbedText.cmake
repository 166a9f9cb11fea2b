# gdtslam_embed_text(TARGET NAMESPACE NAME=FILE[,FILE...]...): gives TARGET a source that defines, in that namespace, the
# function std::string_view NAME() with the text of the files, one after the other, and NAME_hash() with the source
# expression 'sha256-...' of a content security policy for an element of HTML that holds a line end and that text. Built
# anew when one of them changes.
#
# Run as a script (-P) with INPUTS (joined by ","), NAME, NAMESPACE and OUTPUT it writes one such source.
if(CMAKE_SCRIPT_MODE_FILE)
  string(REPLACE "," ";" inputs "${INPUTS}")
  set(pieces "")
  set(content "\n") # of the element: the text begins on a line of its own
  foreach(input IN LISTS inputs)
    file(READ ${input} text)
    string(FIND "${text}" ")embedded\"" end)
    if(NOT end EQUAL -1)
      message(FATAL_ERROR "${input} holds the mark that ends an embedded text")
    endif()
    string(APPEND content "${text}")
    string(APPEND pieces "R\"embedded(${text})embedded\"\n")
  endforeach()
  # Base64 of the digest: two letters for three hexadecimal digits. 256 bits fill 42 letters and four bits of a 43rd.
  string(SHA256 digest "${content}")
  string(APPEND digest "00")
  set(alphabet "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/")
  set(hash "")
  foreach(begin RANGE 0 63 3)
    string(SUBSTRING ${digest} ${begin} 3 digits)
    math(EXPR high "0x${digits} >> 6")
    math(EXPR low "0x${digits} & 63")
    string(SUBSTRING ${alphabet} ${high} 1 first)
    string(SUBSTRING ${alphabet} ${low} 1 second)
    string(APPEND hash ${first}${second})
  endforeach()
  string(SUBSTRING ${hash} 0 43 hash)
  file(WRITE ${OUTPUT} "// Made by cmake/GdtslamEmbedText.cmake.\n#include <string_view>\n\nnamespace ${NAMESPACE} {\n"
    "std::string_view ${NAME}();\nstd::string_view ${NAME}() {\n  return ${pieces};\n}\n"
    "std::string_view ${NAME}_hash();\nstd::string_view ${NAME}_hash() { return \"'sha256-${hash}='\"; }\n}  // namespace ${NAMESPACE}\n")
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
