# The compute shaders as part of the build: shaders/*.comp to SPIR-V, checked by spirv-val, as constants in headers. No
# optimiser runs over them: it may reorder arithmetic, and drivers optimise anyway.

# gdtslam_find_vulkan_tools(): the headers and programs that building the Vulkan backend takes, or one clear error.
function(gdtslam_find_vulkan_tools)
  find_path(GDTSLAM_VULKAN_INCLUDE vulkan/vulkan_raii.hpp)
  find_program(GDTSLAM_GLSLANG_VALIDATOR glslangValidator)
  find_program(GDTSLAM_SPIRV_VAL spirv-val)
  find_package(glm QUIET)
  mark_as_advanced(GDTSLAM_VULKAN_INCLUDE GDTSLAM_GLSLANG_VALIDATOR GDTSLAM_SPIRV_VAL)
  set(missing "")
  set(packages "")
  foreach(needed "GDTSLAM_VULKAN_INCLUDE,vulkan/vulkan_raii.hpp,libvulkan-dev"
                 "GDTSLAM_GLSLANG_VALIDATOR,glslangValidator,glslang-tools"
                 "GDTSLAM_SPIRV_VAL,spirv-val,spirv-tools"
                 "glm_FOUND,glm,libglm-dev")
    string(REPLACE "," ";" needed "${needed}")
    list(GET needed 0 variable)
    list(GET needed 1 what)
    list(GET needed 2 package)
    if(NOT ${variable})
      list(APPEND missing ${what})
      list(APPEND packages ${package})
    endif()
  endforeach()
  if(missing)
    list(JOIN missing ", " missing)
    list(JOIN packages " " packages)
    message(FATAL_ERROR "The Vulkan backend cannot be built: ${missing} not found. Install the Debian packages "
      "${packages}, or configure with -DGDTSLAM_BUILD_VULKAN=OFF to build for the CPU only.")
  endif()
endfunction()

# gdtslam_shaders(TARGET): gives TARGET the header shaders.hpp, which defines gdtslam::shader::<stem>, a constant
# ShaderSource, for every shaders/<stem>.comp, and builds anew what an edit of a shader or of common/*.glsl touches.
function(gdtslam_shaders target)
  set(source_dir ${PROJECT_SOURCE_DIR}/shaders)
  set(binary_dir ${CMAKE_CURRENT_BINARY_DIR}/shaders)
  file(MAKE_DIRECTORY ${binary_dir})
  file(GLOB sources CONFIGURE_DEPENDS ${source_dir}/*.comp)
  set(headers "")
  set(umbrella "// Made by cmake/GdtslamShaders.cmake.\n#pragma once\n\n")
  foreach(source IN LISTS sources)
    get_filename_component(stem ${source} NAME_WE)
    set(spirv ${binary_dir}/${stem}.spv)
    set(header ${binary_dir}/${stem}.spv.hpp)
    add_custom_command(OUTPUT ${spirv} ${header} # the file of dependencies names the first
      COMMAND ${GDTSLAM_GLSLANG_VALIDATOR} -V --quiet --target-env vulkan1.2 -I${source_dir} --depfile ${spirv}.d
        -o ${spirv} ${source}
      COMMAND ${GDTSLAM_SPIRV_VAL} --target-env vulkan1.2 ${spirv}
      COMMAND ${CMAKE_COMMAND} -DSPIRV=${spirv} -DHEADER=${header} -DSTEM=${stem}
        -P ${PROJECT_SOURCE_DIR}/cmake/GdtslamEmbedSpirv.cmake
      DEPENDS ${source} ${PROJECT_SOURCE_DIR}/cmake/GdtslamEmbedSpirv.cmake
      DEPFILE ${spirv}.d COMMENT "Shader ${stem}" VERBATIM)
    list(APPEND headers ${header})
    string(APPEND umbrella "#include \"${stem}.spv.hpp\"\n")
  endforeach()
  file(CONFIGURE OUTPUT ${binary_dir}/shaders.hpp CONTENT "${umbrella}" @ONLY)
  target_sources(${target} PRIVATE ${headers})
  target_include_directories(${target} PRIVATE ${binary_dir})
endfunction()
