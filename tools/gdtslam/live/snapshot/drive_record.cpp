#include "drive_record.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace gdtslam {

// The path begins with a keyframe, whatever its scan.
void DriveRecord::take(const MappedScan& mapped) {
  const bool is_keyframe = mapped.match.merged || taken_ == 0;
  News news{.scan = {.stamp_s = mapped.match.stamp_s,
                     .T_front_base = mapped.match.T_map_base,
                     .ends_keyframe = is_keyframe && mapped.ends_observation,
                     .is_shown = is_keyframe && mapped.match.accepted},
            .ranges = {}};
  if (news.scan.is_shown) news.ranges = mapped.scan;
  const std::lock_guard lock(mutex_);
  ++taken_;
  news_.push_back(std::move(news));
  if (mapped.closed_keyframes.valid()) asked_ = mapped.closed_keyframes;
}

std::uint64_t DriveRecord::scans() const {
  const std::lock_guard lock(mutex_);
  return taken_;
}

// Where the loops are is taken over once it is known; a mapper that has ended tells no more.
void DriveRecord::take_news() {
  std::vector<News> news;
  {
    const std::lock_guard lock(mutex_);
    news.swap(news_);
    if (asked_.valid()) awaited_ = std::exchange(asked_, {});
  }
  for (const News& one : news) {
    scans_.put(one.scan);
    if (one.scan.is_shown) {
      ranges_.put(one.ranges);
      T_front_shown_.push_back(one.scan.T_front_base);
    }
    if (!one.scan.ends_keyframe) continue;
    T_front_keyframes_.push_back(one.scan.T_front_base);
    shown_.push_back(T_front_shown_.size());
  }
  if (!awaited_.valid() || awaited_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  try {
    closed_ = std::exchange(awaited_, {}).get();
    map_.reset();
  } catch (const std::future_error&) {
  }
}

std::vector<Pose2> DriveRecord::keyframe_poses() const {
  std::vector<Pose2> poses = closed_.T_map_base;
  poses.resize(std::min(poses.size(), T_front_keyframes_.size()));
  for (std::size_t k = poses.size(); k < T_front_keyframes_.size(); ++k) {
    poses.push_back(closed_.T_closed_front * T_front_keyframes_[k]);
  }
  return poses;
}

void DriveRecord::cast(const std::vector<Pose2>& poses) {
  if (!map_) {
    map_.emplace(config_, limits_);
    to_cast_.emplace(ranges_);
    in_hand_.reset();
    cast_ = 0;
  }
  for (std::size_t k = 0; k < poses.size(); ++k) {
    for (; cast_ < shown_[k]; ++cast_) {
      if (!in_hand_) in_hand_ = to_cast_->next();
      const bool is_keyframe = T_front_shown_[cast_] == T_front_keyframes_[k];
      map_->add(*in_hand_, is_keyframe ? poses[k] : poses[k] * between(T_front_keyframes_[k], T_front_shown_[cast_]));
      in_hand_.reset();
    }
  }
}

DriveState DriveRecord::state() {
  take_news();
  const std::vector<Pose2> poses = keyframe_poses();
  cast(poses);
  DriveState state{.map = map_->build(), .trajectory = {}};
  state.trajectory.reserve(scans_.size());
  Shelf<Scan>::Reader scans(scans_);
  std::size_t next = 0;  // keyframe
  while (state.trajectory.size() < scans_.size()) {
    const Scan scan = scans.next();
    if (scan.ends_keyframe) ++next;
    state.trajectory.push_back(
        {scan.stamp_s, poses[next - 1] * between(T_front_keyframes_[next - 1], scan.T_front_base)});
  }
  return state;
}

}  // namespace gdtslam
