# OpenCV is a peer that `gdtslam-lab bench` measures in the same run, never a part of the product. Debian's imgproc package has no
# OpenCVConfig.cmake, so its parts are looked for one by one; without them the benchmark says that the peer is missing.
option(GDTSLAM_BENCH_OPENCV "Measure OpenCV beside our kernels in gdtslam-lab bench, where it is installed" ON)

# gdtslam_measure_opencv(TARGET): links OpenCV's core and imgproc and defines GDTSLAM_HAVE_OPENCV when they are there.
function(gdtslam_measure_opencv target)
  if(NOT GDTSLAM_BENCH_OPENCV)
    return()
  endif()
  find_path(GDTSLAM_OPENCV_INCLUDE opencv2/imgproc.hpp PATH_SUFFIXES opencv4)
  find_library(GDTSLAM_OPENCV_CORE opencv_core)
  find_library(GDTSLAM_OPENCV_IMGPROC opencv_imgproc)
  mark_as_advanced(GDTSLAM_OPENCV_INCLUDE GDTSLAM_OPENCV_CORE GDTSLAM_OPENCV_IMGPROC)
  if(NOT GDTSLAM_OPENCV_INCLUDE OR NOT GDTSLAM_OPENCV_CORE OR NOT GDTSLAM_OPENCV_IMGPROC)
    message(STATUS "gdtslam-lab bench: no OpenCV here, so no peer for the distance transforms")
    return()
  endif()
  target_include_directories(${target} SYSTEM PRIVATE ${GDTSLAM_OPENCV_INCLUDE})
  target_link_libraries(${target} PRIVATE ${GDTSLAM_OPENCV_IMGPROC} ${GDTSLAM_OPENCV_CORE})
  target_compile_definitions(${target} PRIVATE GDTSLAM_HAVE_OPENCV)
endfunction()
