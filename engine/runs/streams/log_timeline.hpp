// What a log looks like over time, from one pass over its records, for a picture. Metres, radians, seconds. Memory is
// bounded, whatever the log's length: where it grows beyond kMostBins bins, two become one. One timeline belongs to one
// thread; O(beams) a scan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/drawing/plots/log_picture.hpp"
#include "gdtslam/core/stream.hpp"
#include "log_check.hpp"

namespace gdtslam {

class LogTimeline {
 public:
  static constexpr std::size_t kMostBins = 1024;  // even
  static constexpr double kFirstWidth_s = 0.05;   // of a bin
  /// What the picture goes along: stamps or, where all of them are the same, the numbers of the scans, with the ranges
  /// alone.
  enum class Along : std::uint8_t { kTime, kScans };
  explicit LogTimeline(const StepBounds& bounds, Along along = Along::kTime)
      : bounds_(bounds), along_(along), width_(along == Along::kTime ? kFirstWidth_s : 1.0) {}
  void add(const LogRecord& record);
  /// Whether there are scans of two times at least.
  [[nodiscard]] bool has_length() const { return last_ > 0.0; }
  /// `check` of the same records: gaps, jumps, the constants that stand for no return.
  [[nodiscard]] LogPicture picture(const LogCheck& check, const std::string& title) const;

 private:
  /// A stretch of time.
  struct Bin {
    std::uint64_t scans = 0;
    std::uint64_t beams = 0;
    std::uint64_t elevations = 0;
    double latest = 0.0;    ///< of the scans, where there are any: after the start
    double driven_s = 0.0;  ///< of the steps of the odometry that end in it
    double path_m = 0.0;
    double turn_rad = 0.0;
    double least_elevation_rad = 0.0;
    double most_elevation_rad = 0.0;
    std::vector<std::uint32_t> returns;  ///< by range, at the resolution of range_bin()
    void add(const Bin& other);
  };
  Bin* bin_at(double place_along);
  void add_scan(const ScanRecord& record);
  void add_ranges(const LaserScan& scan, double place);
  void add_odometry(double stamp_s, const Pose2& T_odom_base);
  void add_elevation(const Tilt& tilt);
  void halve();
  [[nodiscard]] std::vector<Bin> bins_for(std::uint64_t Bin::*what, std::uint64_t each) const;
  [[nodiscard]] std::string subtitle(const LogCheck& check) const;
  [[nodiscard]] double width_of(const std::vector<Bin>& bins) const;
  void set_rates(LogPicture& picture, const LogCheck& check) const;
  void set_motion(LogPicture& picture, const std::vector<Bin>& bins) const;
  void set_elevations(LogPicture& picture) const;
  void set_ranges(LogPicture& picture, std::vector<Bin> bins, const LogCheck& check) const;
  void set_events(LogPicture& picture, const LogCheck& check) const;

  StepBounds bounds_;
  Along along_;
  std::optional<double> start_s_;  ///< stamp of the first scan
  double last_ = 0.0;              ///< of the latest scan, after the start; seconds or scans
  double width_;                   ///< of a bin, likewise
  std::vector<Bin> bins_;
  std::uint64_t scans_ = 0;   ///< along scans
  std::uint64_t strays_ = 0;  ///< scans that were stamped weeks away
  std::uint64_t strays_in_row_ = 0;
  bool has_scans_odometry_ = false;  ///< then records between do not count
  std::optional<Odometry> last_odometry_;
};

}  // namespace gdtslam
