#include "odometry_track.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace gdtslam {
namespace {

constexpr std::size_t kStepsOfMedian = 32;

}  // namespace

double OdometryTrack::usual_step_s() const {
  std::vector<double> steps_s;
  for (std::size_t i = entries_.size(); i-- > 1 && steps_s.size() < kStepsOfMedian;) {
    if (entries_[i - 1].stretch == entries_[i].stretch) {
      steps_s.push_back(entries_[i].pose.stamp_s - entries_[i - 1].pose.stamp_s);
    }
  }
  if (steps_s.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>(steps_s.size() / 2);
  std::nth_element(steps_s.begin(), middle, steps_s.end());
  return *middle;
}

bool OdometryTrack::is_leap(double step_s) const { return step_s > kLeap_s && step_s > kLeapSteps * usual_step_s(); }

bool OdometryTrack::is_in_doubt() const {
  return !past_.empty() && is_leap(entries_.back().pose.stamp_s - past_.back().stamp_s);
}

void OdometryTrack::append(const Odometry& pose) {
  const bool goes_on = !entries_.empty() && entries_.back().stretch == stretch_;
  entries_.push_back({pose, stretch_, goes_on && is_leap(pose.stamp_s - entries_.back().pose.stamp_s)});
  if (entries_.size() > kMostPoses) entries_.pop_front();
}

OdometryTrack::Taken OdometryTrack::take(const Odometry& pose) {
  if (entries_.empty() || pose.stamp_s > entries_.back().pose.stamp_s) {
    past_.clear();
    append(pose);
    return Taken::kNext;
  }
  if (!std::isfinite(pose.stamp_s)) return Taken::kPast;
  if (pose.stamp_s == (past_.empty() ? entries_.back().pose : past_.back()).stamp_s) return Taken::kRepeated;
  if (!past_.empty() && pose.stamp_s <= past_.back().stamp_s) past_.clear();
  past_.push_back(pose);
  if (past_.size() < kSetBack) return Taken::kPast;
  last_before_s_ = entries_.back().pose.stamp_s;
  first_after_s_ = past_.front().stamp_s;
  const bool were_wild = forget_wild();
  if (!were_wild) ++stretch_;
  for (const Odometry& right : std::exchange(past_, {})) append(right);
  return were_wild ? Taken::kForgot : Taken::kSetBack;
}

// Forgets the poses after a leap if they are fewer than kSetBack and the poses in the past continue from before the
// leap.
bool OdometryTrack::forget_wild() {
  for (std::size_t wild = 1; wild < kSetBack && wild < entries_.size(); ++wild) {
    const Entry& first = entries_[entries_.size() - wild];
    if (!first.leaps || first.stretch != stretch_) continue;
    if (entries_[entries_.size() - wild - 1].pose.stamp_s >= past_.front().stamp_s) return false;
    entries_.resize(entries_.size() - wild);
    return true;
  }
  return false;
}

bool OdometryTrack::is_known(std::uint64_t stretch, double stamp_s) const {
  if (entries_.empty()) return false;
  if (stretch < stretch_) return true;
  const Entry& last = entries_.back();
  if (last.pose.stamp_s < stamp_s) return false;
  return !last.leaps || (entries_.size() > 1 && entries_[entries_.size() - 2].pose.stamp_s >= stamp_s);
}

OdometryTrack::Around OdometryTrack::around(std::uint64_t stretch, double stamp_s) const {
  const auto is_earlier = [](const Entry& entry, const std::pair<std::uint64_t, double>& at) {
    return entry.stretch != at.first ? entry.stretch < at.first : entry.pose.stamp_s < at.second;
  };
  const auto after = std::lower_bound(entries_.begin(), entries_.end(), std::pair(stretch, stamp_s), is_earlier);
  Around found;
  if (after != entries_.end() && after->stretch == stretch) found.after = &after->pose;
  if (after != entries_.begin() && std::prev(after)->stretch == stretch) found.before = &std::prev(after)->pose;
  if (found.before == nullptr || found.after == nullptr) return found;
  const double gap_s = found.after->stamp_s - found.before->stamp_s;
  if (gap_s > kMostGap_s && gap_s > kLeapSteps * usual_step_s()) {
    const bool is_after_nearer = found.after->stamp_s - stamp_s < stamp_s - found.before->stamp_s;
    (is_after_nearer ? found.before : found.after) = is_after_nearer ? found.after : found.before;
  }
  return found;
}

}  // namespace gdtslam
