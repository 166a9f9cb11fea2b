// Finds the pose of a scan anywhere in an existing map, without odometry; the work of `gdtslam localize`. Frames: robot
// in the map, metres and radians. Thread-safe without a device; with a device one object belongs to one thread. Cost:
// some tenths of a second of CPU time a scan on a map of 50 m.
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
  std::optional<double> max_seconds{};  ///< limit for a pose; none: until it is proven
  bool with_runner_up = true;           ///< also finds the best pose elsewhere
  std::optional<double> good_fit_m{};   ///< largest mean distance of a good fit; none: from the map
  /// The first search elsewhere only decides with a wider gap whether a pose there is as good; if that stays open, a
  /// second search follows. Limits on boxes do not count the boxes that cover the map.
  static constexpr double kElsewhereGaps = 8.0;
  static constexpr std::uint64_t kRunnerUpBoxes = 50000;  ///< boxes of the first search elsewhere
  static constexpr std::uint64_t kElsewhereBoxes = 6000000;
  static constexpr std::uint64_t kWaitingBoxes = 400000;  ///< boxes of either search while a robot waits
  static constexpr std::uint64_t kChangedBoxes = 100000;  ///< boxes if much may have changed
  /// Least share of a scan that the map explains for the rest to count as changes since the map was made.
  static constexpr double kLeastExplained = 0.7;
  static constexpr double kLeastKnown = 0.5;  ///< least share of a scan in the map for a scan of the map
  static constexpr double kElsewhereM = 1.0;  ///< a pose this far away is elsewhere
  static constexpr double kElsewhereRad = rad_from_deg(20.0);  ///< or a pose turned this far
};

/// Result of the search for a scan, without the proof.
enum class Verdict : std::uint8_t {
  kFound,
  kAmbiguous,  ///< the proof does not exclude an equally good pose elsewhere
  kPoorFit,    ///< the best pose has a larger mean distance than scans of the mapped place
  kNoPose,     ///< too few returns, or the search ended before it had one
};
inline constexpr std::array kVerdicts{Verdict::kFound, Verdict::kAmbiguous, Verdict::kPoorFit, Verdict::kNoPose};
/// "poor fit"
std::string_view to_string(Verdict verdict);

/// A scan and the result of its search.
struct LocalizedScan {
  std::uint64_t index = 0;  ///< in the log
  double stamp_s = 0.0;
  std::uint32_t points = 0;
  double cpu_s = 0.0;
  bool has_returns = false;             ///< enough returns for a search
  std::optional<CertifiedResult> best;  ///< none without returns, or if the search ended before it had a pose
  std::optional<CertifiedResult> runner_up;
  bool is_elsewhere_open = false;  ///< the search elsewhere ended before it had tried a pose, without a result
  std::uint32_t as_good = 0;       ///< cost units: up to this difference a pose elsewhere counts as equally good
  Verdict verdict = Verdict::kNoPose;
  /// Found without a good fit: the map explains enough of the scan, and the rest has changed.
  bool is_changed = false;
  /// True if the proof does not exclude an equally good pose elsewhere.
  [[nodiscard]] bool is_ambiguous() const;
  /// True if it is proven that no pose is better than the best by more than the gap, or that no pose is a good fit.
  [[nodiscard]] bool is_proven() const {
    return best && (best->certified() || best->stop == CertifiedStop::kBoundReached);
  }
};

/// The verdict on a scan after its searches.
Verdict verdict_of(const LocalizedScan& scan, double good_fit_m);

class Localizer {
 public:
  /// `map` is a run folder, its gdt.yaml, or the map.yaml of an occupancy map; a device must outlive this. Throws
  /// InputError, FileError, DeviceError.
  Localizer(const std::string& map, const MapperConfig& config, const LocalizeLimits& limits, Backend& backend);

  /// Throws DeviceError.
  [[nodiscard]] LocalizedScan localize(const LaserScan& scan, std::uint64_t index) const;
  /// The same for a waiting robot, with bounded time: no pose is proven if none is a good fit or it takes too long, and
  /// a pose elsewhere counts as equally good if deciding takes too long. `with_changes`: a pose is also found if the
  /// map explains enough of the scan well, and the scan fits nowhere else.
  [[nodiscard]] LocalizedScan find(const LaserScan& scan, std::uint64_t index, bool with_changes = false) const;
  /// True if a scan may show a changed place: the map explains that share of it, with that mean distance.
  [[nodiscard]] bool may_be_changed(double explained, double mean_distance_m) const {
    return explained >= LocalizeLimits::kLeastExplained && mean_distance_m <= good_fit_.distance_m;
  }
  /// The searched poses: known cells of the map, all headings.
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
