// Clouds in another format: PLY, PCD, or normal distributions of cubes (.ndt).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gdtslam {

struct ConvertedClouds {
  std::uint64_t points = 0;  ///< read, or sampled of cubes
  std::uint64_t cubes = 0;   ///< 0 if no normal distributions are read or written
  double cell_m = 0.0;       ///< edge of the cubes
  double deviation_m = 0.0;  ///< of the points from their cubes' planes, root mean square
  std::uint64_t bytes = 0;   ///< written
};

/// True if the name is that of a cloud.
bool is_cloud_name(const std::string& path);

/// Writes all inputs, which share a frame, as one cloud. Points are read piece by piece, so cubes need memory for the
/// space that is filled, and not for the points. Throws UsageError, InputError, FileError.
ConvertedClouds convert_clouds(const std::vector<std::string>& inputs, const std::string& output, double cell_m,
                               double spacing_m);

}  // namespace gdtslam
