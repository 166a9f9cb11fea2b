// CARMEN log lines (docs/formats.md): FLASER if the number of beams gives their bearings, else ROBOTLASER1; RLASER and
// ROBOTLASER2 for the second laser; ODOM; ENCODER; TILT; PARAM. Metres, radians, seconds; poses and stamps with six
// decimals or with as many as read back as the same number; the same bytes on every host. One object belongs to one
// thread.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

class CarmenWriter {
 public:
  /// Enough decimals to read back the same number, for ranges, poses and stamps.
  static constexpr int kAsNeeded = -1;
  /// Ranges are written with this many decimals, 0 to 9; `host`: name of the computer, one word.
  explicit CarmenWriter(int range_decimals, std::string host = "simulated")
      : range_decimals_(range_decimals), host_(std::move(host)) {}

  /// Each returns its line with the line end. Speeds are relative to the previous odometry written.
  std::string parameter(std::string_view name, std::string_view value) const;
  std::string odometry(const Odometry& odometry);
  std::string encoder(const Encoder& encoder) const;
  std::string tilt(const Tilt& tilt) const;
  /// The scan must have odometry, laser 0 or 1, and a step above 0.
  std::string scan(const ScanRecord& record);
  /// True if the line needs no bearings; then it also has no limit of the ranges.
  [[nodiscard]] bool is_told_by_beam_count(const LaserScan& scan) const;

 private:
  struct Speeds {
    double forward_m_per_s = 0.0;
    double turn_rad_per_s = 0.0;
  };
  Speeds move_to(double stamp_s, const Pose2& T_odom_base);
  void append_field(std::string& line, double value) const;
  void append_bearing(std::string& line, double value) const;
  void append_pose(std::string& line, const Pose2& pose) const;
  void append_stamp(std::string& line, double stamp_s) const;
  void append_ranges(std::string& line, const std::vector<float>& ranges_m) const;

  int range_decimals_;
  std::string host_;
  Speeds speeds_;
  bool has_last_ = false;
  double last_stamp_s_ = 0.0;
  Pose2 T_odom_last_;
};

/// The number with that many decimals, correctly rounded, independent of the locale.
std::string fixed_text(double value, int decimals);

}  // namespace gdtslam
