// Follows a robot by scans and wheels in a fixed map, and finds its start by itself. If the map contradicts the scans,
// as after somebody has carried the robot away, it is searched in the whole map. Frame: the map's, metres and radians.
// One object belongs to one thread. Cost of a scan: one match, or two while a found place is on trial; some tenths of a
// second for a search.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "engine/mapping/tracking/map_tracker.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "run.hpp"

namespace gdtslam {

/// Source of a scan's pose.
enum class Whereabouts : std::uint8_t {
  kUnknown,    ///< none: not found yet, or lost
  kFound,      ///< a search of the whole map; the drive since then is too short to confirm it
  kTracked,    ///< a match near the prediction with a good fit, by the localizer's limit, of most of the scan
  kPredicted,  ///< the wheels and poor matches or none, since the last good match
};
inline constexpr std::array kWhereabouts{Whereabouts::kUnknown, Whereabouts::kFound, Whereabouts::kTracked,
                                         Whereabouts::kPredicted};
/// For people and programs: "tracked".
std::string_view to_string(Whereabouts whereabouts);

struct TrackedPose {
  Whereabouts whereabouts = Whereabouts::kUnknown;
  Pose2 T_map_base;              ///< identity if unknown
  double explained = 0.0;        ///< share of the scan's points near an obstacle of the map
  double mean_distance_m = 0.0;  ///< mean distance of the points to the map's obstacles, capped
  PoseCovariance covariance;     ///< within the map, along its axes; if the place is right (`is_ambiguous`)
  /// Another place of the map fitted equally well when the robot was found here, and no later search has distinguished
  /// the two.
  bool is_ambiguous = false;
};

/// Limits for when to search a robot, and when to confirm a found place.
struct TrackLimits {
  double least_known = 0.5;       ///< share of a scan's points in the map; with fewer the scan counts as outside
  double lost_m = 10.0;           ///< the robot is lost after this much path in the map without a good match
  double lost_sigma_m = 1.0;      ///< or if the pose is this uncertain, as outside of the map
  std::uint32_t doubt_scans = 5;  ///< scans without a good match after which it may have been carried away
  /// During a search, the next scan is searched after this many scans, or this much path by the wheels; a turn by 90
  /// degrees counts as a metre. Rarer after more failures.
  std::uint32_t search_scans = 25;
  double search_m = 0.5;
  std::uint32_t most_rare = 4;
  double ask_again_m = 0.5;  ///< while the place is ambiguous, a scan is searched after this much path
  double trial_m =
      1.0;  ///< a place is confirmed after this much path with good matches; a turn by 90 degrees counts as a metre
  double changed_trial_m = 3.0;      ///< the same for a place found with changes
  std::uint32_t plain_searches = 1;  ///< searches that must fail before changes are allowed
  std::uint32_t trial_faults = 3;    ///< scans in a row without a good match that refute a place
  double better =
      0.7;  ///< a found place replaces the followed one if its distances are below this share of the other's
};

class RobotTracker {
 public:
  /// Localizer and CPU must outlive this. Throws like MapTracker.
  RobotTracker(const Localizer& localizer, const MapperConfig& config, Backend& cpu, const TrackLimits& limits = {});

  /// Takes the next scan of the drive, with the robot's pose by its wheels if known. Throws DeviceError.
  TrackedPose follow(const LaserScan& scan, const std::optional<Pose2>& T_odom_base);

  /// Searches of the whole map so far.
  [[nodiscard]] std::uint64_t searches() const { return searches_; }

 private:
  /// A possible place of the robot, and how its scans have matched there.
  struct Place {
    MapTracker tracker;
    MatchResult match;        // match of the last scan; poses from the kernels' origin
    bool is_good = false;     // about the last scan, like the next two
    bool is_whole = false;    // good without any change
    bool is_outside = false;  // too little of the scan lies in the map
    bool is_ambiguous = false;
    bool is_changed = false;      // found with changes
    double path = 0.0;            // since it was found; a quarter turn counts as a metre
    double unmatched_m = 0.0;     // path in the map since a good match
    std::uint32_t faults = 0;     // scans in a row without a good match (without a whole one unless found with changes)
    double distance_sum_m = 0.0;  // sum over the scans since the trial began
  };
  struct Scan {
    const LaserScan& scan;
    const std::optional<Pose2>& T_odom_base;
    std::uint64_t index;
  };

  void follow_in(Place& place, const Scan& scan) const;
  [[nodiscard]] bool is_lost(const Place& place) const;
  void try_place(const Scan& scan);
  [[nodiscard]] bool is_trial_better() const;
  [[nodiscard]] bool is_search_due(const std::optional<Pose2>& T_odom_base);
  void look_for(const Scan& scan);
  [[nodiscard]] bool is_here(const Pose2& T_map_base) const;
  [[nodiscard]] Place place_at(const LocalizedScan& found, const Scan& scan) const;
  [[nodiscard]] TrackedPose in_map(const Place& place, Whereabouts whereabouts) const;

  const Localizer& localizer_;
  TrackLimits limits_;
  MapTracker origin_;  // the field that all places share
  std::optional<Place> here_;
  std::optional<Place> trial_;
  std::uint64_t scans_ = 0;
  std::uint64_t searches_ = 0;
  std::uint32_t failed_searches_ = 0;  // since it was last followed
  std::uint32_t since_search_ = 0;     // scans
  std::optional<Pose2> T_odom_searched_;
  double unasked_m_ = 0.0;  // path since the last search
};

}  // namespace gdtslam
