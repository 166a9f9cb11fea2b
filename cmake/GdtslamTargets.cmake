# Helpers that give every target of the project the same flags.

# Compile options of our own code: warnings, and the arithmetic that makes results equal everywhere.
add_library(gdtslam_options INTERFACE)
target_compile_options(gdtslam_options INTERFACE
  -ffp-contract=off # the same bits with and without FMA (docs/numerics.md)
  -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wold-style-cast -Woverloaded-virtual
  -Wdouble-promotion -Wformat=2
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict> # GCC 12 reports "literal" + std::string falsely (GCC bug 105651)
  # clang reports double{x} as an implicit promotion, the & of loops without branches as a mistake, and embedded pages
  # as too long for a string.
  $<$<CXX_COMPILER_ID:Clang>:-Wno-double-promotion -Wno-bitwise-instead-of-logical -Wno-overlength-strings>)
# Who compiles for a processor of his own (-march=native) gets the same bits as anybody: GCC 12 makes fused additions and
# subtractions of neighbours whatever -ffp-contract says, and Eigen with wider registers adds in another order, fuses by
# itself, and aligns, and frees, what it shares with Ceres otherwise than Ceres does. The kernels choose their
# instructions when they run.
include(CheckCXXSourceCompiles)
set(CMAKE_TRY_COMPILE_CONFIGURATION ${CMAKE_BUILD_TYPE}) # whose flags may name the processor
check_cxx_source_compiles("
#if !defined(__AVX__) && !defined(__FMA__)
#error the baseline
#endif
int main() {}" GDTSLAM_IS_BEYOND_BASELINE)
unset(CMAKE_TRY_COMPILE_CONFIGURATION)
if(GDTSLAM_IS_BEYOND_BASELINE)
  target_compile_options(gdtslam_options INTERFACE -U__AVX__ -U__AVX2__ -U__AVX512F__ -U__FMA__
    $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)
endif()
if(CMAKE_UNITY_BUILD)
  # Sources that are included into one are taken for headers, in which types of anonymous namespaces would be a mistake.
  target_compile_options(gdtslam_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
if(GDTSLAM_WERROR)
  target_compile_options(gdtslam_options INTERFACE -Werror)
endif()
# Of the libraries that an archive names, those that nothing asks for are not loaded: some compilers say so to the linker,
# others do not.
add_link_options(LINKER:--as-needed)
if(GDTSLAM_SANITIZE)
  add_compile_options(-fsanitize=${GDTSLAM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${GDTSLAM_SANITIZE})
  # Each compiler has its own way to tell the program.
  foreach(sanitizer IN ITEMS address thread)
    if(GDTSLAM_SANITIZE MATCHES ${sanitizer})
      string(TOUPPER ${sanitizer} upper)
      add_compile_definitions(GDTSLAM_SANITIZE_${upper})
    endif()
  endforeach()
endif()

# gdtslam_precompile(TARGET GROUP HEADER...): the first target of a group makes a precompiled header of these, the others
# of the group use it. Sources with compile options of their own need the property SKIP_PRECOMPILE_HEADERS.
function(gdtslam_precompile target group)
  if(NOT GDTSLAM_PRECOMPILE)
    return()
  endif()
  get_property(maker GLOBAL PROPERTY GDTSLAM_PRECOMPILED_${group})
  if(maker)
    target_precompile_headers(${target} REUSE_FROM ${maker})
  else()
    target_precompile_headers(${target} PRIVATE ${ARGN})
    set_property(GLOBAL PROPERTY GDTSLAM_PRECOMPILED_${group} ${target})
  endif()
  # ccache can only keep what was compiled with a precompiled header when GCC names it in its output. And GCC 12 forgets
  # that std::string comes from a system header, so its false reports about moved strings (bugs 105329, 105651) come out;
  # a build with GDTSLAM_PRECOMPILE=OFF has these warnings.
  target_compile_options(${target} PRIVATE
    $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess;-Wno-array-bounds;-Wno-stringop-overflow;-Wno-stringop-overread>)
endfunction()
set(GDTSLAM_COMMON_HEADERS <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <functional> <memory>
  <optional> <span> <string> <string_view> <utility> <vector>)

# gdtslam_library(NAME [WITHOUT FOLDER...]): the library gdtslam::NAME from this folder, the folders in it but those named,
# and its public headers in include/. Private headers are included by their path from the project's root.
function(gdtslam_library name)
  cmake_parse_arguments(PARSE_ARGV 1 library "" "" "WITHOUT")
  file(GLOB_RECURSE sources RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS *.cpp)
  foreach(folder IN LISTS library_WITHOUT)
    list(FILTER sources EXCLUDE REGEX "^${folder}/")
  endforeach()
  add_library(gdtslam_${name} STATIC ${sources})
  add_library(gdtslam::${name} ALIAS gdtslam_${name})
  set_target_properties(gdtslam_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(gdtslam_${name} PUBLIC cxx_std_20)
  target_include_directories(gdtslam_${name}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(gdtslam_${name} PRIVATE $<BUILD_INTERFACE:gdtslam_options>)
  gdtslam_precompile(gdtslam_${name} libraries ${GDTSLAM_COMMON_HEADERS})
  install(TARGETS gdtslam_${name} EXPORT gdtslam_${name}_targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${name})
  if(IS_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/include)
    install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${name})
  endif()
  set_property(GLOBAL APPEND PROPERTY GDTSLAM_COMPONENTS ${name})
endfunction()
