// Pictures against pictures that lie in tests/golden/viewer as PNG files. Two measures, both needed: the mean
// difference finds a whole picture that is a little off (a wrong colour map), the share of pixels that are clearly off
// finds a small thing in the wrong place (a missing layer). Colours count as much as their pixel is opaque.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "gdtslam/drawing/image.hpp"

namespace gdtslam::test {

struct ImageDifference {
  double mean = 0.0;         ///< of the absolute differences of all channels, 0 to 255
  double share_clear = 0.0;  ///< of the pixels with a channel that differs by more than clear_step
};
/// What two renderings of one scene by different drivers may differ by; a picture of mostly empty background needs
/// less.
struct ImageTolerance {
  double mean = 1.0;
  double share_clear = 0.005;
  int clear_step = 24;
};

/// Throws where the sizes differ: such pictures cannot be compared.
ImageDifference difference_of(const RgbaImage& a, const RgbaImage& b, int clear_step = ImageTolerance{}.clear_step);
/// True where a golden `expected` would be met by `actual`; to show that a deliberate fault would not.
bool is_alike(const RgbaImage& actual, const RgbaImage& expected, const ImageTolerance& tolerance = {});

/// Throw std::runtime_error with the path.
RgbaImage read_png(const std::string& path);
void write_png(const RgbaImage& image, const std::string& path);

/// Compares with tests/golden/viewer/NAME.png. On failure writes NAME.actual.png, NAME.expected.png and
/// NAME.difference.png (differences four times as strong) to tests/golden of the build folder and says so. With
/// GDTSLAM_UPDATE_GOLDENS=1 in the environment the picture becomes the golden, after which it must be looked at.
::testing::AssertionResult matches_golden(const RgbaImage& actual, const std::string& name,
                                          const ImageTolerance& tolerance = {});
/// The golden itself, for faults that must not meet it. Throws std::runtime_error where there is none.
RgbaImage golden(const std::string& name);

}  // namespace gdtslam::test
