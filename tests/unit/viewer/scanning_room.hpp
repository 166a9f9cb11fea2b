// A robot with a nodding laser in an empty round room, measured without noise by formulas of our own: the truth for
// the tests of the scanning film.
#pragma once

#include <cmath>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam::test {

struct ScanningRoom {
  calib::SweepModel model = calib::sweep_model_of_preset("paper-b");
  double turn_s = 4.0;         ///< of the crank
  double speed_m_per_s = 0.2;  ///< straight on
  double heading_rad = 0.7;
  double sensor_forward_m = 0.0;
  double length_s = 8.0;
  int beams = 181;
  static constexpr double kScan_s = 0.025;

  [[nodiscard]] double crank_rad(double stamp_s) const {
    return model.encoder.zero_rad + model.encoder.direction * 2.0 * M_PI * stamp_s / turn_s;
  }
  [[nodiscard]] Pose2 T_map_base(double stamp_s) const {
    return {speed_m_per_s * stamp_s * std::cos(heading_rad), speed_m_per_s * stamp_s * std::sin(heading_rad),
            heading_rad};
  }
  /// Every beam of 180 degrees hits something 2 to 3 m away.
  [[nodiscard]] Cloud cloud() const {
    Cloud points;
    const int scans = static_cast<int>(length_s / kScan_s);
    for (int scan = 0; scan < scans; ++scan) {
      for (int beam = 0; beam < beams; ++beam) {
        const double stamp_s = kScan_s * (scan + 0.5 * beam / beams);
        points.push_back(measured(stamp_s, M_PI * (beam / (beams - 1.0) - 0.5), static_cast<std::uint32_t>(scan)));
      }
    }
    return points;
  }
  [[nodiscard]] CloudPoint measured(double stamp_s, double bearing_rad, std::uint32_t scan) const {
    const double elevation = *calib::elevation_rad(model, crank_rad(stamp_s));
    const double range = 2.5 + 0.5 * std::sin(3.0 * bearing_rad);
    const double forward = sensor_forward_m + range * std::cos(bearing_rad) * std::cos(elevation);
    const double left = range * std::sin(bearing_rad);
    const double up = model.mount.height_m + range * std::cos(bearing_rad) * std::sin(elevation);
    const Pose2 base = T_map_base(stamp_s);
    return {.x_m = static_cast<float>(base.x_m + std::cos(heading_rad) * forward - std::sin(heading_rad) * left),
            .y_m = static_cast<float>(base.y_m + std::sin(heading_rad) * forward + std::cos(heading_rad) * left),
            .z_m = static_cast<float>(up),
            .elevation_rad = static_cast<float>(elevation),
            .stamp_s = stamp_s,
            .scan = scan};
  }
  [[nodiscard]] Trajectory trajectory() const {
    Trajectory poses;
    for (int i = 0; i <= static_cast<int>(length_s); ++i) poses.push_back({1.0 * i, T_map_base(1.0 * i)});
    return poses;
  }
};

}  // namespace gdtslam::test
