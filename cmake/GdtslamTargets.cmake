# Helpers that give every target of the project the same flags.

# Compile options of our own code: warnings, and the arithmetic that makes results equal everywhere.
add_library(gdtslam_options INTERFACE)
target_compile_options(gdtslam_options INTERFACE
  -ffp-contract=off # the same bits with and without FMA (docs/numerics.md)
  -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wold-style-cast -Woverloaded-virtual
  -Wdouble-promotion -Wformat=2
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>) # GCC 12 reports "literal" + std::string falsely (GCC bug 105651)
if(GDTSLAM_WERROR)
  target_compile_options(gdtslam_options INTERFACE -Werror)
endif()
if(GDTSLAM_SANITIZE)
  add_compile_options(-fsanitize=${GDTSLAM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${GDTSLAM_SANITIZE})
endif()

# gdtslam_library(NAME): the library gdtslam::NAME from src/*.cpp and include/ of this folder.
function(gdtslam_library name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/*.cpp)
  add_library(gdtslam_${name} STATIC ${sources})
  add_library(gdtslam::${name} ALIAS gdtslam_${name})
  set_target_properties(gdtslam_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(gdtslam_${name} PUBLIC cxx_std_20)
  target_include_directories(gdtslam_${name} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(gdtslam_${name} PRIVATE $<BUILD_INTERFACE:gdtslam_options>)
  install(TARGETS gdtslam_${name} EXPORT gdtslam_${name}_targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${name})
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${name})
  set_property(GLOBAL APPEND PROPERTY GDTSLAM_COMPONENTS ${name})
endfunction()
