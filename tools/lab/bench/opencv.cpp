// The peer of the distance transforms. OpenCV is optional and serves this comparison only.
#include "gdtslam/core/error.hpp"
#include "rows.hpp"

#ifdef GDTSLAM_HAVE_OPENCV
#include <algorithm>
#include <opencv2/imgproc.hpp>
#endif

namespace gdtslam {

#ifdef GDTSLAM_HAVE_OPENCV

std::string opencv_version() { return CV_VERSION; }

std::vector<std::uint8_t> opencv_input(const std::vector<std::uint8_t>& seeds) {
  std::vector<std::uint8_t> input(seeds.size());
  std::transform(seeds.begin(), seeds.end(), input.begin(),
                 [](std::uint8_t seed) { return static_cast<std::uint8_t>(seed == 0 ? 1 : 0); });
  return input;
}

void opencv_distance(std::vector<std::uint8_t>& input, std::uint32_t size, OpenCvMask mask,
                     std::vector<float>& distance) {
  const int side = static_cast<int>(size);
  distance.resize(input.size());
  const cv::Mat source(side, side, CV_8UC1, input.data());
  cv::Mat target(side, side, CV_32FC1, distance.data());
  cv::setNumThreads(1);
  cv::distanceTransform(source, target, cv::DIST_L2,
                        mask == OpenCvMask::kPrecise ? cv::DIST_MASK_PRECISE : cv::DIST_MASK_5);
}

#else

std::string opencv_version() { return {}; }

std::vector<std::uint8_t> opencv_input(const std::vector<std::uint8_t>& seeds) { return seeds; }

void opencv_distance(std::vector<std::uint8_t>&, std::uint32_t, OpenCvMask, std::vector<float>&) {
  throw UnavailableError("this build has no OpenCV to compare with");
}

#endif

}  // namespace gdtslam
