// CARMEN log lines (docs/formats.md): FLASER where the number of beams tells their bearings, else ROBOTLASER1; ODOM;
// ENCODER; PARAM. Metres, radians, seconds; poses and stamps with six decimals, the same bytes on every host. One
// object belongs to one thread.
#pragma once

#include <string>
#include <string_view>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

class CarmenWriter {
 public:
  /// Ranges are written with this many decimals, 0 to 9.
  explicit CarmenWriter(int range_decimals) : range_decimals_(range_decimals) {}

  /// Each returns its line with the line end. Speeds are those since the odometry written before.
  std::string parameter(std::string_view name, std::string_view value) const;
  std::string odometry(const Odometry& odometry);
  std::string encoder(const Encoder& encoder) const;
  /// The scan must carry odometry.
  std::string scan(const ScanRecord& record);

 private:
  struct Speeds {
    double forward_m_per_s = 0.0;
    double turn_rad_per_s = 0.0;
  };
  Speeds move_to(double stamp_s, const Pose2& T_odom_base);

  int range_decimals_;
  Speeds speeds_;
  bool has_last_ = false;
  double last_stamp_s_ = 0.0;
  Pose2 T_odom_last_;
};

/// The number with that many decimals, correctly rounded, independent of the locale.
std::string fixed_text(double value, int decimals);

}  // namespace gdtslam
