# Script: writes the words of the SPIR-V module SPIRV to HEADER as gdtslam::shader::<STEM>_spirv.
file(READ ${SPIRV} bytes HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1U, " words "${bytes}")
string(REPEAT "..........., " 8 line) # eight words
string(REGEX REPLACE "(${line})" "\\1\n    " words "${words}")
file(WRITE ${HEADER} "// Made from ${STEM}.comp.\n#pragma once\n\n#include <cstdint>\n\nnamespace gdtslam::shader {\n"
  "inline constexpr std::uint32_t ${STEM}_spirv[] = {\n    ${words}\n};\n}  // namespace gdtslam::shader\n")
