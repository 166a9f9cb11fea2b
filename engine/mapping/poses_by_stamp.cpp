#include "poses_by_stamp.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace gdtslam {

PosesByStamp::PosesByStamp(Trajectory trajectory) : poses_(std::move(trajectory)) {
  std::erase_if(poses_, [](const StampedPose& pose) { return !std::isfinite(pose.stamp_s); });
  std::stable_sort(poses_.begin(), poses_.end(), [](const auto& a, const auto& b) { return a.stamp_s < b.stamp_s; });
}

std::optional<Pose2> PosesByStamp::find(double stamp_s, double tolerance_s) const {
  const auto later = [](double t_s, const StampedPose& pose) { return t_s < pose.stamp_s; };
  const auto after = std::upper_bound(poses_.begin(), poses_.end(), stamp_s, later);
  const StampedPose* best = after == poses_.begin() ? nullptr : &*std::prev(after);
  if (after != poses_.end() && (best == nullptr || after->stamp_s - stamp_s < stamp_s - best->stamp_s)) {
    best = &*std::prev(std::upper_bound(after, poses_.end(), after->stamp_s, later));
  }
  if (best == nullptr || !(std::fabs(best->stamp_s - stamp_s) <= tolerance_s)) return std::nullopt;
  return best->T_map_base;
}

}  // namespace gdtslam
