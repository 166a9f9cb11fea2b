// The pose of scans in the whole of a map that was made before, without odometry; the work of `gdtslam localize`.
// Frames: robot in the map, metres and radians. Without a device one object may serve several threads, with one it
// belongs to one. Cost: some tenths of a second of CPU time a scan on a map of 50 m.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/localizer/map_field.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {

/// Limits of the search for each scan.
struct LocalizeLimits {
  double gap_m = 0.005;                 ///< gap of the mean distance
  std::optional<double> max_seconds{};  ///< for a pose; none: until it is proven
  bool with_runner_up = true;           ///< the best pose elsewhere
  std::optional<double> good_fit_m{};   ///< the largest mean distance that is one; none: what the map tells
  /// Elsewhere less is asked at first: whether anything there is as good. Where that leaves it open, more. Boxes are
  /// those beyond the ones that cover the map, which are as many as it is large.
  static constexpr double kElsewhereGaps = 8.0;
  static constexpr std::uint64_t kRunnerUpBoxes = 50000;  ///< for a pose there
  static constexpr std::uint64_t kElsewhereBoxes = 6000000;
  static constexpr std::uint64_t kWaitingBoxes = 400000;  ///< boxes of either search while a robot waits
  static constexpr std::uint64_t kChangedBoxes = 100000;  ///< boxes if much may have changed
  /// Share of a scan that the map explains, with which the rest may be what has changed since the map was made.
  static constexpr double kLeastExplained = 0.7;
  static constexpr double kLeastKnown = 0.5;                   ///< share of a scan in the map, for it to be one of it
  static constexpr double kElsewhereM = 1.0;                   ///< elsewhere is this far away
  static constexpr double kElsewhereRad = rad_from_deg(20.0);  ///< or turned this far
};

/// Result of the search for a scan, the proof aside.
enum class Verdict : std::uint8_t {
  kFound,
  kAmbiguous,  ///< a pose elsewhere may be as good, as far as the proof tells
  kPoorFit,    ///< the best pose leaves a larger mean distance than scans of the mapped place do
  kNoPose,     ///< too few returns, or the search was cut short before it had one
};
inline constexpr std::array kVerdicts{Verdict::kFound, Verdict::kAmbiguous, Verdict::kPoorFit, Verdict::kNoPose};
/// "poor fit"
std::string_view to_string(Verdict verdict);

/// A scan and what was found.
struct LocalizedScan {
  std::uint64_t index = 0;  ///< in the log
  double stamp_s = 0.0;
  std::uint32_t points = 0;
  double cpu_s = 0.0;
  bool has_returns = false;             ///< enough to be searched for
  std::optional<CertifiedResult> best;  ///< none without them, or if the search was cut before it had a pose
  std::optional<CertifiedResult> runner_up;
  bool is_elsewhere_open = false;  ///< the search elsewhere ended before it had tried a pose, and tells nothing
  std::uint32_t as_good = 0;  ///< cost units: a pose elsewhere counts as one that may be as good up to this difference
  Verdict verdict = Verdict::kNoPose;
  /// It was found though it is no good fit: the map explains enough of it, and the rest has changed.
  bool is_changed = false;
  /// Whether a pose elsewhere may be as good, as far as the proof tells.
  [[nodiscard]] bool is_ambiguous() const;
  /// Whether no pose is better than the best by more than the gap, or none so good that the scan would be found.
  [[nodiscard]] bool is_proven() const {
    return best && (best->certified() || best->stop == CertifiedStop::kBoundReached);
  }
};

/// The verdict about a scan whose poses are known.
Verdict verdict_of(const LocalizedScan& scan, double good_fit_m);

class Localizer {
 public:
  /// `map` is a run folder, its gdt.yaml, or the map.yaml of an occupancy map; the backend must outlive this where it
  /// is a device. Throws InputError, FileError, DeviceError.
  Localizer(const std::string& map, const MapperConfig& config, const LocalizeLimits& limits, Backend& backend);

  /// Throws DeviceError.
  [[nodiscard]] LocalizedScan localize(const LaserScan& scan, std::uint64_t index) const;
  /// The same for a robot that is waiting, which will find out: no pose is proven where none is a good fit or it takes
  /// too long, and one elsewhere counts as being as good where it takes too long to tell. With changes a
  /// pose is found, too, at which the map explains enough of the scan, and that well, and that fits nowhere else.
  [[nodiscard]] LocalizedScan find(const LaserScan& scan, std::uint64_t index, bool with_changes = false) const;
  /// Whether a scan of which the map explains that share, with that mean distance, may be one of a place that changed.
  [[nodiscard]] bool may_be_changed(double explained, double mean_distance_m) const {
    return explained >= LocalizeLimits::kLeastExplained && mean_distance_m <= good_fit_.distance_m;
  }
  /// The poses that are searched: those over what the map knows, all headings.
  [[nodiscard]] const PoseWindow& window() const { return window_; }
  [[nodiscard]] const std::string& file() const { return field_.path; }
  [[nodiscard]] const MapField& field() const { return field_; }
  [[nodiscard]] const LocalizeLimits& limits() const { return limits_; }
  [[nodiscard]] const FitLimit& good_fit() const { return good_fit_; }
  [[nodiscard]] bool has_device() const { return map_->device() != nullptr; }

 private:
  [[nodiscard]] double resolution_m() const { return field_.file.geometry.resolution_m; }
  [[nodiscard]] CertifiedResult search(std::span<const PointCells> points, PoseWindow window,
                                       CertifiedOptions options) const;
  [[nodiscard]] CertifiedOptions options_with(double gap_m) const;
  [[nodiscard]] std::uint32_t to_units(double distance_m, std::size_t points) const;
  [[nodiscard]] std::vector<double> own_distances_m() const;
  [[nodiscard]] std::uint32_t least_lead(const CertifiedResult& best, std::size_t points) const;
  [[nodiscard]] std::optional<CertifiedResult> look_everywhere(std::span<const PointCells> points, double good_m,
                                                               CertifiedOptions options) const;
  std::vector<Pose2> look_everywhere(std::span<const PointCells> points, LocalizedScan& found) const;
  [[nodiscard]] CertifiedOptions elsewhere_options(const Pose2& T_map_base, double times_as_far) const;
  void look_elsewhere(std::span<const PointCells> points, std::uint64_t most_boxes, std::vector<Pose2> starts,
                      LocalizedScan& found) const;
  [[nodiscard]] LocalizedScan begun(const LaserScan& scan, std::uint64_t index,
                                    std::span<const PointCells> points) const;
  [[nodiscard]] double known_share(std::span<const PointCells> points, const Pose2& T_map_base) const;
  [[nodiscard]] bool may_be_changed(std::span<const PointCells> points, const Pose2& T_map_base) const;
  [[nodiscard]] double worst_of_changed_m() const;

  MapperConfig config_;
  LocalizeLimits limits_;
  MapField field_;
  std::optional<CertifiedMap> map_;
  PoseWindow window_;
  FitLimit good_fit_;
};

}  // namespace gdtslam
