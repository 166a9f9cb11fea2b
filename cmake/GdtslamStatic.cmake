# GDTSLAM_STATIC: every package that the command links is linked statically, the C++ runtime too, so that the program asks a
# machine for nothing but the C library. It is how the relocatable bundle is built (GdtslamBundle.cmake). Static, and not
# shared libraries in a folder beside the program, because of the drivers: a Vulkan driver is loaded into the process and
# brings libstdc++, libz and others; a process has each of them once. With an older one of ours loaded first, a driver that
# needs a newer one does not load.
#
# The packages' own targets are defined here, before find_package looks for them anywhere in the tree.
option(GDTSLAM_STATIC "Link the packages and the C++ runtime statically, for the bundle (without simulator and calibration)" OFF)
set(GDTSLAM_STATIC_INPUTS "") # archives and headers of other projects that end in the program; the bundle gives their licences
if(NOT GDTSLAM_STATIC)
  return()
endif()
if(GDTSLAM_BUILD_SIM)
  message(FATAL_ERROR "gdtslam: GDTSLAM_STATIC needs -DGDTSLAM_BUILD_SIM=OFF: there is no static Embree")
endif()
if(GDTSLAM_SANITIZE)
  message(FATAL_ERROR "gdtslam: GDTSLAM_STATIC and GDTSLAM_SANITIZE exclude each other")
endif()
set(GDTSLAM_BUILD_LAB OFF) # Debian has no static google-benchmark
set(GDTSLAM_BUILD_C OFF) # not all static libraries of Debian may go into a shared one
set(GDTSLAM_BUILD_CALIBRATION OFF) # Ceres brings BLAS, LAPACK and SuiteSparse along
set(GDTSLAM_BUILD_VIEWER OFF) # VTK, Mesa and X are the system's
set(GDTSLAM_BUILD_LIVE_PAGE OFF) # libwebsockets brings OpenSSL's TLS along
# What the program does not use goes, so that it does not ask for newer symbols of the C library than it needs.
add_link_options(-static-libstdc++ -static-libgcc -Wl,--gc-sections)

# gdtslam_static_archive(VARIABLE NAME) and gdtslam_static_header(VARIABLE HEADER [SUFFIX]): find what a package gives to the
# program; VARIABLE becomes the archive, or the folder that is searched for the header.
macro(gdtslam_static_archive variable name)
  find_library(${variable} ${name} REQUIRED)
  mark_as_advanced(${variable})
  list(APPEND GDTSLAM_STATIC_INPUTS ${${variable}})
endmacro()
macro(gdtslam_static_header variable name)
  find_path(${variable} ${name} PATH_SUFFIXES ${ARGN} REQUIRED)
  mark_as_advanced(${variable})
  list(APPEND GDTSLAM_STATIC_INPUTS ${${variable}}/${name})
endmacro()

gdtslam_static_header(GDTSLAM_EIGEN_FOLDER Eigen/Core eigen3)
gdtslam_static_header(GDTSLAM_NANOFLANN_FOLDER nanoflann.hpp)
if(GDTSLAM_BUILD_VULKAN)
  gdtslam_static_header(GDTSLAM_VULKAN_FOLDER vulkan/vulkan.h)
  gdtslam_static_header(GDTSLAM_GLM_FOLDER glm/glm.hpp)
endif()
if(GDTSLAM_BUILD_TOOLS)
  gdtslam_static_header(GDTSLAM_JSON_FOLDER nlohmann/json.hpp)
  gdtslam_static_header(GDTSLAM_CLI11_FOLDER CLI/CLI.hpp)
  gdtslam_static_archive(GDTSLAM_ZLIB_ARCHIVE libz.a)
  set(ZLIB_LIBRARY ${GDTSLAM_ZLIB_ARCHIVE})
  gdtslam_static_archive(GDTSLAM_BZIP2_ARCHIVE libbz2.a)
  set(BZIP2_LIBRARY_RELEASE ${GDTSLAM_BZIP2_ARCHIVE})
  gdtslam_static_archive(GDTSLAM_LZ4_ARCHIVE liblz4.a)
  add_library(PkgConfig::LZ4 STATIC IMPORTED)
  set_target_properties(PkgConfig::LZ4 PROPERTIES IMPORTED_LOCATION ${GDTSLAM_LZ4_ARCHIVE})
  gdtslam_static_archive(GDTSLAM_ZSTD_ARCHIVE libzstd.a)
  add_library(PkgConfig::ZSTD STATIC IMPORTED)
  set_target_properties(PkgConfig::ZSTD PROPERTIES IMPORTED_LOCATION ${GDTSLAM_ZSTD_ARCHIVE})
  gdtslam_static_archive(GDTSLAM_SQLITE_ARCHIVE libsqlite3.a)
  set(SQLite3_LIBRARY ${GDTSLAM_SQLITE_ARCHIVE})
  gdtslam_static_archive(GDTSLAM_LZMA_ARCHIVE liblzma.a)
  set(LIBLZMA_LIBRARY ${GDTSLAM_LZMA_ARCHIVE})
  gdtslam_static_archive(GDTSLAM_PNG_ARCHIVE libpng.a)
  set(PNG_LIBRARY ${GDTSLAM_PNG_ARCHIVE})
  gdtslam_static_archive(GDTSLAM_CRYPTO_ARCHIVE libcrypto.a)
  set(OPENSSL_CRYPTO_LIBRARY ${GDTSLAM_CRYPTO_ARCHIVE})

  gdtslam_static_archive(GDTSLAM_YAML_CPP_ARCHIVE libyaml-cpp.a)
  # Cairo draws on memory: what it needs of X and GLib is in objects that nothing asks for.
  gdtslam_static_header(GDTSLAM_CAIRO_FOLDER cairo.h cairo)
  gdtslam_static_archive(GDTSLAM_CAIRO_ARCHIVE libcairo.a)
  set(cairo_needs "")
  foreach(name pixman-1 fontconfig freetype expat brotlidec brotlicommon uuid)
    string(MAKE_C_IDENTIFIER "GDTSLAM_${name}_ARCHIVE" variable)
    gdtslam_static_archive(${variable} lib${name}.a)
    list(APPEND cairo_needs ${${variable}})
  endforeach()
  add_library(PkgConfig::CAIRO STATIC IMPORTED)
  set_target_properties(PkgConfig::CAIRO PROPERTIES IMPORTED_LOCATION ${GDTSLAM_CAIRO_ARCHIVE}
    INTERFACE_INCLUDE_DIRECTORIES ${GDTSLAM_CAIRO_FOLDER} INTERFACE_LINK_LIBRARIES "${cairo_needs};${GDTSLAM_PNG_ARCHIVE};${GDTSLAM_ZLIB_ARCHIVE};m")

  find_path(GDTSLAM_YAML_CPP_FOLDER yaml-cpp/yaml.h REQUIRED)
  mark_as_advanced(GDTSLAM_YAML_CPP_FOLDER)
  add_library(yaml-cpp STATIC IMPORTED)
  set_target_properties(yaml-cpp PROPERTIES IMPORTED_LOCATION ${GDTSLAM_YAML_CPP_ARCHIVE}
    INTERFACE_INCLUDE_DIRECTORIES ${GDTSLAM_YAML_CPP_FOLDER})

  gdtslam_static_header(GDTSLAM_FMT_FOLDER fmt/format.h)
  foreach(target fmt::fmt fmt::fmt-header-only) # Debian has no static libfmt; the headers hold all of it
    add_library(${target} INTERFACE IMPORTED)
    set_target_properties(${target} PROPERTIES INTERFACE_COMPILE_DEFINITIONS FMT_HEADER_ONLY=1
      INTERFACE_INCLUDE_DIRECTORIES ${GDTSLAM_FMT_FOLDER})
  endforeach()
endif()

foreach(archive libstdc++.a libgcc.a)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=${archive} OUTPUT_VARIABLE path
    OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  if(NOT IS_ABSOLUTE "${path}")
    message(FATAL_ERROR "gdtslam: the compiler has no ${archive}, which GDTSLAM_STATIC needs")
  endif()
  list(APPEND GDTSLAM_STATIC_INPUTS ${path})
endforeach()
