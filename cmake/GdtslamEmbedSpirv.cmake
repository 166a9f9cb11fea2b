# Script: writes the words of the SPIR-V module SPIRV to HEADER as gdtslam::shader::<STEM>.
file(READ ${SPIRV} bytes HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1U, " words "${bytes}")
string(REPEAT "..........., " 8 line) # eight words
string(REGEX REPLACE "(${line})" "\\1\n    " words "${words}")
file(WRITE ${HEADER} "// Made from ${STEM}.comp.\n#pragma once\n\n#include \"engine/vulkan/dispatch/shader_table.hpp\"\n\n"
  "namespace gdtslam::shader {\ninline constexpr std::uint32_t ${STEM}_words[] = {\n    ${words}\n};\n"
  "inline constexpr ShaderSource ${STEM}{\"${STEM}\", ${STEM}_words};\n}  // namespace gdtslam::shader\n")
