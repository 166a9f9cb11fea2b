// A robot followed by scans and wheels in a map that stays as it is, from a start that is found by itself; where the
// map contradicts its scans it is looked for in the whole map, as after somebody has carried it away. Frame: the map's,
// metres and radians. One object belongs to one thread. Cost of a scan: that of a match, of two while a place that was
// found is on trial; of a search some tenths of a second.
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

/// How the pose of a scan is known.
enum class Whereabouts : std::uint8_t {
  kUnknown,    ///< not at all: not found yet, or lost
  kFound,      ///< by a search of the whole map; the drive since then is too short to tell whether it is right
  kTracked,    ///< by a match near where it should be that is a good fit, as the localizer has it, of most of the scan
  kPredicted,  ///< by the wheels and by matches that are poor or none, since the last one that was good
};
inline constexpr std::array kWhereabouts{Whereabouts::kUnknown, Whereabouts::kFound, Whereabouts::kTracked,
                                         Whereabouts::kPredicted};
/// For people and programs: "tracked".
std::string_view to_string(Whereabouts whereabouts);

struct TrackedPose {
  Whereabouts whereabouts = Whereabouts::kUnknown;
  Pose2 T_map_base;              ///< identity if it is unknown
  double explained = 0.0;        ///< share of the scan's points that lie near an obstacle of the map there
  double mean_distance_m = 0.0;  ///< mean distance of the points to the map's obstacles, capped
  PoseCovariance covariance;     ///< within the map, along its axes; of the place as such `is_ambiguous` tells
  /// Another place of the map fitted as well when the robot was found here, and no search of a scan since then has told
  /// the two apart.
  bool is_ambiguous = false;
};

/// When a robot is looked for, and when it is believed to be where it was found.
struct TrackLimits {
  double least_known = 0.5;       ///< share of a scan's points in the map, with fewer of which the map does not count
  double lost_m = 10.0;           ///< after so much path in the map without a good match nothing is known any more
  double lost_sigma_m = 1.0;      ///< nor where the pose has become so unsure, as outside of the map
  std::uint32_t doubt_scans = 5;  ///< so many scans without a good match: it may have been carried away
  /// While it is looked for, the next scan is searched after so many, or after so much path by the wheels; a turn by 90
  /// degrees counts as a metre. After more failures more rarely.
  std::uint32_t search_scans = 25;
  double search_m = 0.5;
  std::uint32_t most_rare = 4;
  double ask_again_m = 0.5;  ///< while it may be elsewhere, one scan after so much path is searched
  double trial_m =
      1.0;  ///< a place is believed after so much path with good matches; a turn by 90 degrees counts as a metre
  double changed_trial_m = 3.0;      ///< path for a place that was found though much has changed there
  std::uint32_t plain_searches = 1;  ///< that must fail before a place may be one that has changed
  std::uint32_t trial_faults = 3;    ///< so many scans in a row that are none refute it
  double better =
      0.7;  ///< a place that was found takes the robot from where it was followed if distances there are so much less
};

class RobotTracker {
 public:
  /// Localizer and CPU must outlive this. Throws what MapTracker throws.
  RobotTracker(const Localizer& localizer, const MapperConfig& config, Backend& cpu, const TrackLimits& limits = {});

  /// The next scan of the drive, with the robot's pose by its wheels if there is one. Throws DeviceError.
  TrackedPose follow(const LaserScan& scan, const std::optional<Pose2>& T_odom_base);

  /// Searches of the whole map so far.
  [[nodiscard]] std::uint64_t searches() const { return searches_; }

 private:
  /// A place where the robot may be, and how its scans have matched there.
  struct Place {
    MapTracker tracker;
    MatchResult match;        // match of the last scan; poses from the kernels' origin
    bool is_good = false;     // about the last scan, like the next two
    bool is_whole = false;    // good without anything that has changed
    bool is_outside = false;  // too little of the scan lies in the map to say anything
    bool is_ambiguous = false;
    bool is_changed = false;      // it was found though much has changed
    double path = 0.0;            // metres and quarter turns since it was found
    double unmatched_m = 0.0;     // path in the map since a good match
    std::uint32_t faults = 0;     // scans in a row without a good match, whole unless it was found as changed
    double distance_sum_m = 0.0;  // sum over the scans since the trial began, like the next
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
  double unasked_m_ = 0.0;  // path since a search said that another place fits as well
};

}  // namespace gdtslam
