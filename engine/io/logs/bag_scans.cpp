#include "bag_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/io/message_text.hpp"

namespace gdtslam {
namespace {

constexpr int kMostSteps = 32;         // up a tree of frames, which may be a ring
constexpr double kLevelCosine = 0.94;  // within 20 degrees
constexpr std::array<std::string_view, 3> kBaseNames{"base_link", "base_footprint", "base"};

/// The laser's own step and direction, from right to left as seen from above.
void turn_right_to_left(LaserScan& scan, bool is_upside_down) {
  if (is_upside_down) {
    scan.first_bearing_rad = -scan.first_bearing_rad;
    scan.bearing_step_rad = -scan.bearing_step_rad;
  }
  if (scan.bearing_step_rad >= 0.0 || scan.ranges_m.empty()) return;
  scan.first_bearing_rad += static_cast<double>(scan.ranges_m.size() - 1) * scan.bearing_step_rad;
  scan.bearing_step_rad = -scan.bearing_step_rad;
  std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
}

/// REP 117: not a number, minus infinity and what is nearer than the least range say nothing of a place.
void clear_missing_ranges(std::vector<float>& ranges_m, double min_range_m) {
  for (float& range_m : ranges_m) {
    if (!(range_m > 0.0F) || static_cast<double>(range_m) < min_range_m) {
      range_m = std::numeric_limits<float>::infinity();
    }
  }
}

}  // namespace

void FrameTree::add(const BagTransform& edge) {
  if (edges_.size() >= kMostEdges && !edges_.contains(edge.child)) return;
  edges_[edge.child] = {edge.parent, edge.T_parent_child};
}

std::optional<Transform3> FrameTree::find(const std::string& frame, const std::string& base) const {
  Transform3 T_here_frame;
  std::string here = frame;
  for (int step = 0; step < kMostSteps; ++step) {
    const bool is_base =
        base.empty() ? std::find(kBaseNames.begin(), kBaseNames.end(), here) != kBaseNames.end() : here == base;
    if (is_base) return T_here_frame;
    const auto edge = edges_.find(here);
    if (edge == edges_.end()) return std::nullopt;
    T_here_frame = edge->second.T_parent_child * T_here_frame;
    here = edge->second.parent;
  }
  return std::nullopt;
}

void BagScans::add_odometry(const BagTransform& pose) {
  if (source_ == PoseSource::kTransforms) return;
  if (source_ == PoseSource::kUnknown) {
    source_ = PoseSource::kOdometry;
    poses_.clear();  // those of transforms
    base_.clear();
  }
  add_pose(pose);
}

void BagScans::add_transform(const BagTransform& transform) {
  if (!transform.parent.starts_with("odom")) {
    frames_.add(transform);
  } else if (source_ != PoseSource::kOdometry && (base_.empty() || base_ == transform.child)) {
    add_pose(transform);
  }
}

void BagScans::add_pose(const BagTransform& pose) {
  if (base_.empty()) base_ = pose.child;
  if (!poses_.empty() && pose.stamp_s <= poses_.back().stamp_s) {
    if (pose.stamp_s < poses_.back().stamp_s) warn_("odometry steps back in time", "it is left out");
    return;
  }
  poses_.push_back({pose.stamp_s, seen_from_above(pose.T_parent_child)});
  if (poses_.size() > kMostPoses) poses_.pop_front();
}

// Along the circular arc between the poses around it; nothing before the first, the last one after it.
std::optional<Pose2> BagScans::odometry_at(double stamp_s) const {
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), stamp_s,
                                      [](const Odometry& pose, double at_s) { return pose.stamp_s < at_s; });
  if (after == poses_.end()) return poses_.empty() ? std::nullopt : std::optional(poses_.back().T_odom_base);
  if (after->stamp_s == stamp_s) return after->T_odom_base;
  if (after == poses_.begin()) return std::nullopt;
  const Odometry& before = *std::prev(after);
  const double share = (stamp_s - before.stamp_s) / (after->stamp_s - before.stamp_s);
  return before.T_odom_base * exp_se2(share * log_se2(between(before.T_odom_base, after->T_odom_base)));
}

// The transforms of the mount may come some messages after the first scan.
bool BagScans::is_mount_known(const std::string& frame) const {
  return options_.T_base_laser.has_value() || mounts_.contains(frame) || frames_.find(frame, base_).has_value();
}

const Transform3& BagScans::mount_of(const std::string& frame) {
  if (const auto known = mounts_.find(frame); known != mounts_.end()) return known->second;
  std::optional<Transform3> mount = frames_.find(frame, base_);
  if (!mount && !options_.T_base_laser) {
    warn_("laser mount unknown",
          fmt::format("no transform leads from frame {} to {}; it is taken as the robot's own frame: state log.mount",
                      in_quotes(frame), base_.empty() ? "a base_link" : in_quotes(base_)));
  }
  if (mount && std::fabs(mount->rotation[8]) < kLevelCosine) {
    warn_("laser is not level", fmt::format("frame {} is tilted by more than 20 degrees", in_quotes(frame)));
  }
  if (mounts_.size() >= kMostEdges) mounts_.clear();
  return mounts_.emplace(frame, mount.value_or(Transform3())).first->second;
}

ScanRecord BagScans::record_of(BagScan scan) {
  const Transform3& mount = mount_of(scan.frame);
  ScanRecord record;
  record.scan.stamp_s = scan.stamp_s;
  record.scan.first_bearing_rad = options_.first_bearing_rad.value_or(scan.first_bearing_rad);
  record.scan.bearing_step_rad = options_.bearing_step_rad.value_or(scan.bearing_step_rad);
  const bool has_limit = std::isfinite(scan.max_range_m) && scan.max_range_m > 0.0;
  record.scan.max_range_m = options_.max_range_m.value_or(has_limit ? scan.max_range_m : 0.0);
  record.scan.ranges_m = std::move(scan.ranges_m);
  clear_missing_ranges(record.scan.ranges_m, scan.min_range_m);
  record.scan.T_base_laser = options_.T_base_laser.value_or(seen_from_above(mount));
  const bool are_stated = options_.bearing_step_rad.has_value();
  if (!are_stated) turn_right_to_left(record.scan, mount.rotation[8] < 0.0);
  record.T_odom_base = odometry_at(scan.stamp_s);
  return record;
}

std::optional<ScanRecord> BagScans::next(bool at_end) {
  if (waiting_.empty()) return std::nullopt;
  const bool must_go = at_end || waiting_.size() > kMostHeldScans;
  const bool has_pose_behind = !poses_.empty() && poses_.back().stamp_s >= waiting_.front().stamp_s;
  if (!must_go && (source_ == PoseSource::kUnknown || !has_pose_behind || !is_mount_known(waiting_.front().frame))) {
    return std::nullopt;
  }
  if (source_ == PoseSource::kUnknown && !poses_.empty()) source_ = PoseSource::kTransforms;
  if (!poses_.empty() && !has_pose_behind) warn_("scan after the last odometry", "it gets the last pose that is known");
  BagScan scan = std::move(waiting_.front());
  waiting_.pop_front();
  return record_of(std::move(scan));
}

}  // namespace gdtslam
