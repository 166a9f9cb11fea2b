// Writes one cloud in each format into a folder, for cloud_interop_test.py to read.
#include <string>

#include "gdtslam/io/cloud_file.hpp"

int main(int /*count*/, char** arguments) {
  using namespace gdtslam;
  const std::string folder = std::string(arguments[1]) + "/";
  Cloud cloud;
  for (std::uint32_t k = 0; k < 1000; ++k) {
    cloud.push_back({.x_m = static_cast<float>(k * 0.1),
                     .y_m = static_cast<float>(-static_cast<double>(k) / 3),
                     .z_m = static_cast<float>(k * 1e-3),
                     .elevation_rad = static_cast<float>(k * 0.01),
                     .stamp_s = 976052857.25 + static_cast<double>(k) / 7,
                     .scan = k});
  }
  for (const auto& [name, format] : {std::pair{"b.ply", CloudFormat::kPlyBinary}, {"b.pcd", CloudFormat::kPcdBinary}}) {
    CloudWriter writer(folder + name, format);
    writer.add(cloud);
    writer.finish();
  }
}
