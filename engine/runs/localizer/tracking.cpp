#include "tracking.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kQuarterTurn_rad = 0.5 * kPi;

}  // namespace

std::string_view to_string(Whereabouts whereabouts) {
  static constexpr std::array<std::string_view, 4> kNames{"unknown", "found", "tracked", "predicted"};
  static_assert(kNames.size() == kWhereabouts.size());
  return kNames.at(static_cast<std::size_t>(whereabouts));
}

RobotTracker::RobotTracker(const Localizer& localizer, const MapperConfig& config, Backend& cpu,
                           const TrackLimits& limits)
    : localizer_(localizer), limits_(limits), origin_(config, localizer.field().view(), cpu) {}

// The tracker counts from the kernels' origin.
TrackedPose RobotTracker::in_map(const Place& place, Whereabouts whereabouts) const {
  const Point2& origin_m = localizer_.field().kernel_origin_m;
  const Pose2& T = place.match.T_map_base;
  return {.whereabouts = whereabouts,
          .T_map_base = {T.x_m + origin_m.x(), T.y_m + origin_m.y(), T.theta_rad},
          .explained = place.match.overlap,
          .mean_distance_m = place.match.mean_cost_m,
          .covariance = place.tracker.covariance(),
          .is_ambiguous = place.is_ambiguous};
}

// A matcher near a wrong place takes the best fit there; only the limit of the whole map shows that the fit is poor.
// Points outside of the map do not count against a place.
void RobotTracker::follow_in(Place& place, const Scan& scan) const {
  const Pose2 before = place.match.T_map_base;
  place.match = place.tracker.process(scan.scan, scan.T_odom_base);
  const KnownFit& known = place.tracker.known_fit();
  const Pose2 step = between(before, place.match.T_map_base);
  const double step_m = step.translation().norm();
  place.path += step_m + std::fabs(step.theta_rad) / kQuarterTurn_rad;
  place.is_outside = known.share < limits_.least_known;
  const bool is_matched = place.match.accepted && !place.is_outside;
  place.is_whole = is_matched && known.mean_distance_m <= localizer_.good_fit().distance_m;
  place.is_good =
      place.is_whole || (is_matched && localizer_.may_be_changed(known.explained, known.explained_distance_m));
  place.faults = place.is_whole || (place.is_good && place.is_changed) ? 0 : place.faults + 1;
  if (place.is_good) {
    place.unmatched_m = 0.0;
  } else if (!place.is_outside) {
    place.unmatched_m += step_m;
  }
  place.distance_sum_m += place.match.mean_cost_m;
}

bool RobotTracker::is_lost(const Place& place) const {
  return place.unmatched_m > limits_.lost_m || place.tracker.covariance().sigma_m() > limits_.lost_sigma_m;
}

TrackedPose RobotTracker::follow(const LaserScan& scan, const std::optional<Pose2>& T_odom_base) {
  const Scan now{scan, T_odom_base, scans_++};
  if (here_) {
    const Pose2 before = here_->match.T_map_base;
    follow_in(*here_, now);
    unasked_m_ += (here_->match.T_map_base.translation() - before.translation()).norm();
    if (here_->is_whole) failed_searches_ = 0;
    if (is_lost(*here_)) here_.reset();
  }
  if (trial_) try_place(now);
  if (!trial_ && is_search_due(T_odom_base)) look_for(now);
  if (here_ && !is_trial_better()) {
    return in_map(*here_, here_->is_good ? Whereabouts::kTracked : Whereabouts::kPredicted);
  }
  return trial_ ? in_map(*trial_, Whereabouts::kFound) : TrackedPose{};
}

// A found place is confirmed after some path; if the robot is followed elsewhere, only if scans fit the found place
// better.
void RobotTracker::try_place(const Scan& scan) {
  follow_in(*trial_, scan);
  const bool is_refuted =
      trial_->faults >= limits_.trial_faults ||
      (trial_->faults > 0 && !trial_->is_changed && trial_->match.mean_cost_m > 2.0 * localizer_.good_fit().distance_m);
  if (is_refuted) return trial_.reset();
  if (trial_->path < (trial_->is_changed ? limits_.changed_trial_m : limits_.trial_m)) return;
  trial_->is_changed = false;  // from now on it is judged like any other
  if (!here_ || is_trial_better()) here_ = std::move(trial_);
  trial_.reset();
}

bool RobotTracker::is_trial_better() const {
  return here_ && trial_ && trial_->distance_sum_m < limits_.better * here_->distance_sum_m;
}

// Searches after a failure wait, because the same place would give the same result.
bool RobotTracker::is_search_due(const std::optional<Pose2>& T_odom_base) {
  if (here_ && here_->is_whole) return here_->is_ambiguous && unasked_m_ >= limits_.ask_again_m;
  if (here_ && here_->faults < limits_.doubt_scans) return false;
  if (failed_searches_ > 0) {
    const auto rarer = static_cast<double>(std::min(failed_searches_, limits_.most_rare));
    bool is_due = ++since_search_ >= limits_.search_scans * rarer;
    if (T_odom_base && T_odom_searched_) {
      const Pose2 moved = between(*T_odom_searched_, *T_odom_base);
      const double path = moved.translation().norm() + std::fabs(moved.theta_rad) / kQuarterTurn_rad;
      is_due = is_due || path >= limits_.search_m * rarer;
    }
    if (!is_due) return false;
  }
  ++failed_searches_;
  since_search_ = 0;
  T_odom_searched_ = T_odom_base;
  return true;
}

bool RobotTracker::is_here(const Pose2& T_map_base) const {
  const Pose2 apart = between(in_map(*here_, Whereabouts::kTracked).T_map_base, T_map_base);
  return apart.translation().norm() < LocalizeLimits::kElsewhereM &&
         std::fabs(apart.theta_rad) < LocalizeLimits::kElsewhereRad;
}

// A followed place becomes unambiguous if the scan fits it alone.
void RobotTracker::look_for(const Scan& scan) {
  ++searches_;
  unasked_m_ = 0.0;
  LocalizedScan found = localizer_.find(scan.scan, scan.index);
  if (found.verdict == Verdict::kPoorFit && !here_ && failed_searches_ > limits_.plain_searches) {
    found = localizer_.find(scan.scan, scan.index, true);
  }
  if (found.verdict != Verdict::kFound && found.verdict != Verdict::kAmbiguous) return;
  const bool is_same = here_ && is_here(found.best->T_map_base);
  if (here_ && here_->is_whole && found.verdict == Verdict::kAmbiguous && !is_same) return;
  if (is_same && here_->is_whole) {
    here_->is_ambiguous = found.verdict == Verdict::kAmbiguous;
    return;
  }
  if (here_) here_->distance_sum_m = here_->match.mean_cost_m;
  Place place = place_at(found, scan);
  if (is_same) {
    place.is_ambiguous = here_->is_ambiguous && place.is_ambiguous;
    here_ = std::move(place);
  } else {
    trial_ = std::move(place);
  }
}

RobotTracker::Place RobotTracker::place_at(const LocalizedScan& found, const Scan& scan) const {
  const Point2& origin_m = localizer_.field().kernel_origin_m;
  const Pose2& T = found.best->T_map_base;
  Place place{.tracker = origin_.another(),
              .match = {},
              .is_ambiguous = found.verdict == Verdict::kAmbiguous,
              .is_changed = found.is_changed};
  place.match.T_map_base = {T.x_m - origin_m.x(), T.y_m - origin_m.y(), T.theta_rad};
  place.tracker.start_at(place.match.T_map_base);
  follow_in(place, scan);  // the next step starts from this odometry
  place.path = 0.0;
  return place;
}

}  // namespace gdtslam
