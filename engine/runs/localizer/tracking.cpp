#include "tracking.hpp"

namespace gdtslam {

RobotTracker::RobotTracker(const Localizer& localizer, const MapperConfig& config, Backend& cpu,
                           const TrackLimits& limits)
    : localizer_(localizer), limits_(limits), tracker_(config, localizer.field().view(), cpu) {}

// The tracker counts from the kernels' origin.
TrackedPose RobotTracker::in_map(const MatchResult& match, Whereabouts whereabouts) const {
  const Point2& origin_m = localizer_.field().kernel_origin_m;
  const Pose2& T = match.T_map_base;
  return {.whereabouts = whereabouts,
          .T_map_base = {T.x_m + origin_m.x(), T.y_m + origin_m.y(), T.theta_rad},
          .explained = match.overlap,
          .mean_distance_m = match.mean_cost_m};
}

// A matcher near a wrong place takes what fits best there; only the map as a whole knows how well scans of it fit.
bool RobotTracker::is_good(const MatchResult& match) const {
  return match.accepted && match.mean_cost_m <= localizer_.good_fit().distance_m;
}

void RobotTracker::count(const MatchResult& match) {
  const double step_m = (match.T_map_base.translation() - last_.translation()).norm();
  const bool is_matched = is_good(match);
  unmatched_m_ = is_matched ? 0.0 : unmatched_m_ + step_m;
  unmatched_scans_ = is_matched ? 0 : unmatched_scans_ + 1;
  last_ = match.T_map_base;
}

bool RobotTracker::is_search_due() {
  if (is_known_ && unmatched_scans_ < limits_.doubt_scans) return false;
  const bool is_due = since_search_ == 0;
  since_search_ = (since_search_ + 1) % limits_.search_every;
  return is_due;
}

TrackedPose RobotTracker::follow(const LaserScan& scan, const std::optional<Pose2>& T_odom_base) {
  const std::uint64_t index = scans_++;
  std::optional<TrackedPose> pose;
  if (is_known_) {
    const MatchResult match = tracker_.process(scan, T_odom_base);
    count(match);
    if (unmatched_scans_ == 0) {
      since_search_ = 0;
      return in_map(match, Whereabouts::kTracked);
    }
    is_known_ = unmatched_m_ <= limits_.lost_m;
    if (is_known_) pose = in_map(match, Whereabouts::kPredicted);
  }
  if (!is_search_due()) return pose.value_or(TrackedPose{});
  ++searches_;
  const LocalizedScan found = localizer_.localize(scan, index, std::nullopt);
  if (found.verdict != Verdict::kFound) return pose.value_or(TrackedPose{});
  const Point2& origin_m = localizer_.field().kernel_origin_m;
  const Pose2& T = found.best->T_map_base;
  last_ = {T.x_m - origin_m.x(), T.y_m - origin_m.y(), T.theta_rad};
  tracker_.start_at(last_);
  is_known_ = true;
  since_search_ = 0;
  const MatchResult match = tracker_.process(scan, T_odom_base);  // the next step is told from these wheels
  count(match);
  return in_map(match, Whereabouts::kFound);
}

}  // namespace gdtslam
