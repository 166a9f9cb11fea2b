// The pose of scans in the whole of a map that was made before, without odometry; the work of `gdtslam localize`.
// Frames: robot in the map, metres and radians. One object belongs to one thread. Cost: some 100 ms a scan on a map of
// 30 m.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/distance_field_file.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {

/// What is asked of each scan.
struct LocalizeLimits {
  double gap_m = 0.005;                 ///< of the mean distance
  std::optional<double> max_seconds{};  ///< for a pose; none: until it is proven
  bool with_runner_up = true;           ///< the best pose elsewhere
  /// Elsewhere much less is asked: whether anything there is as good.
  static constexpr double kElsewhereGaps = 4.0;
  static constexpr std::uint64_t kElsewhereBoxes = 1000000;
  static constexpr double kElsewhereM = 1.0;                   ///< elsewhere is this far away
  static constexpr double kElsewhereRad = 0.3490658503988659;  ///< or turned this far: 20 degrees
};

/// A scan and what was found.
struct LocalizedScan {
  std::uint64_t index = 0;  ///< in the log
  double stamp_s = 0.0;
  std::uint32_t points = 0;
  double wall_s = 0.0;
  CertifiedResult best;
  std::optional<CertifiedResult> runner_up;
  /// Whether a pose elsewhere may be as good, as far as the proof tells.
  [[nodiscard]] bool is_ambiguous() const;
};

class Localizer {
 public:
  /// `map` is a run folder or its gdt.yaml. Throws InputError, FileError.
  Localizer(const std::string& map, const MapperConfig& config, const LocalizeLimits& limits);

  /// Nothing where the scan has too few returns.
  std::optional<LocalizedScan> localize(const LaserScan& scan, std::uint64_t index) const;
  /// The poses that are searched: those over what the map knows, all headings.
  [[nodiscard]] const PoseWindow& window() const { return window_; }
  [[nodiscard]] const std::string& file() const { return path_; }

 private:
  MapperConfig config_;
  LocalizeLimits limits_;
  std::string path_;
  DistanceFieldFile file_;
  std::optional<CertifiedMap> map_;
  PoseWindow window_;
};

}  // namespace gdtslam
