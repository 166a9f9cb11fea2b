#include "scan_assembler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/elementary.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kLevelSine = 0.0523;  // sine of 3 degrees, which makes ranges 0.14 % too long
constexpr double kMostSweep_s = 10.0;  // a longer one is not a sweep but an unset field

/// Time from the first beam to the last; 0 if the message does not state it.
double sweep_s(const ScanMessage& scan) {
  if (!std::isfinite(scan.beam_period_s) || scan.ranges_m.empty()) return 0.0;
  const double duration_s = static_cast<double>(scan.ranges_m.size() - 1) * std::fabs(scan.beam_period_s);
  return duration_s <= kMostSweep_s ? duration_s : 0.0;
}

/// Turns the beams to run from right to left as seen from above.
void turn_right_to_left(LaserScan& scan, bool is_upside_down) {
  if (is_upside_down) {
    scan.first_bearing_rad = -scan.first_bearing_rad;
    scan.bearing_step_rad = -scan.bearing_step_rad;
  }
  if (scan.bearing_step_rad < 0.0) turn_beams_round(scan);
}

/// REP 117: not a number, minus infinity and ranges below the minimum carry no information.
void clear_missing_ranges(std::vector<float>& ranges_m, double min_range_m) {
  for (float& range_m : ranges_m) {
    if (!(range_m > 0.0F) || static_cast<double>(range_m) < min_range_m) {
      range_m = std::numeric_limits<float>::infinity();
    }
  }
}

}  // namespace

OdometryChoice::OdometryChoice(const std::string& text) : topic(text) {
  const std::string transforms = std::string(kTransformTopic) + ":";
  if (!text.starts_with(transforms)) return;
  topic = kTransformTopic;
  frame = text.substr(transforms.size());
  const std::size_t colon = frame.find(':');
  if (colon == std::string::npos) return;
  base = frame.substr(colon + 1);
  frame.resize(colon);
}

ScanAssembler::ScanAssembler(const ReadOptions& options, Warn warn)
    : options_(options), choice_(options.topics.odometry), warn_(std::move(warn)) {
  if (choice_.topic.empty()) return;
  source_ = choice_.is_transform() ? PoseSource::kTransforms : PoseSource::kOdometry;
}

std::size_t ScanAssembler::add_laser(const std::string& topic) {
  Laser laser{.T_base_laser = options_.T_base_laser};
  for (const TopicMount& mount : options_.topics.mounts) {
    if (mount.topic == topic) laser.T_base_laser = mount.T_base_laser;
  }
  lasers_.push_back(laser);
  return lasers_.size() - 1;
}

auto ScanAssembler::scan_taker(std::size_t laser) {
  return [this, laser](ScanMessage&& scan, double received_s, bool has_stamp) {
    if (!has_stamp) warn_("scan without stamp", "it gets the time when it was recorded");
    take_scan(laser, std::move(scan), received_s);
  };
}

void ScanAssembler::add_scan(std::size_t laser, ScanMessage scan, double received_s) {
  lasers_[laser].frame = scan.frame;
  lasers_[laser].stamps.add(std::move(scan), received_s, scan_taker(laser));
}

void ScanAssembler::take_scan(std::size_t laser, ScanMessage scan, double received_s) {
  scan_clock_.add(received_s, scan.stamp_s, sweep_s(scan));
  // Its clock may have been set back together with the odometry's: the next poses decide.
  const bool is_back = lasers_[laser].last_stamp_s - scan.stamp_s > OdometryTrack::kLeap_s;
  const std::uint64_t due = is_back ? poses_taken_ + OdometryTrack::kSetBack : 0;
  lasers_[laser].last_stamp_s = scan.stamp_s;
  auto place = waiting_.end();
  for (auto before = waiting_.end(); before != waiting_.begin();) {
    --before;
    const auto* const held = std::get_if<HeldScan>(&*before);
    if (held == nullptr) continue;
    if (held->laser == laser || held->scan.stamp_s <= scan.stamp_s) break;
    place = before;
  }
  waiting_.insert(place, HeldScan{.laser = laser, .scan = std::move(scan), .stretch = poses_.stretch(), .due = due});
  ++held_scans_;
}

void ScanAssembler::add_odometry(const TransformMessage& pose, double received_s) {
  if (source_ == PoseSource::kTransforms) return;
  if (source_ == PoseSource::kUnknown) {
    source_ = PoseSource::kOdometry;
    start_odometry();  // the poses so far are from transforms
  }
  add_pose(pose, received_s);
}

void ScanAssembler::start_odometry() {
  poses_ = {};
  pose_stamps_ = {};
  pose_clock_ = {};
  pose_shift_s_.reset();
  base_.clear();
}

// A recording may have the odometry of several robots and sensors. The right one leads to the base that the laser is
// mounted on, or at least has the laser's namespace.
int ScanAssembler::fit_to_laser(const std::string& odometry, const std::string& base) const {
  const std::string laser = lasers_.empty() ? "" : lasers_.front().frame;
  if (frames_.find(laser, base)) return 3;
  return (frame_namespace(laser) == frame_namespace(base) ? 2 : 0) +
         (name_in_namespace(odometry).starts_with("odom") ? 1 : 0);
}

bool ScanAssembler::add_transform(const TransformMessage& transform, double received_s, bool is_static) {
  const std::string& base = transform.child;
  const bool is_odometry = choice_.frame.empty()
                               ? is_odometry_frame(transform.parent)
                               : transform.parent == choice_.frame && (choice_.base.empty() || base == choice_.base);
  if (!is_odometry || is_static) {
    frames_.add(transform.parent, base, transform.T_parent_child);
    return false;
  }
  if (source_ == PoseSource::kOdometry) return false;
  if (!base_.empty() && (base != base_ || transform.parent != odometry_frame_)) {
    const bool has_given_scans = !mounts_.empty();
    if (has_given_scans || fit_to_laser(transform.parent, base) <= fit_to_laser(odometry_frame_, base_)) {
      warn_("second odometry transform",
            fmt::format("{} to {} is used, {} to {} is not; --odom tf:FRAME:BASE chooses", in_quotes(odometry_frame_),
                        in_quotes(base_), in_quotes(transform.parent), in_quotes(base)));
      return false;
    }
    start_odometry();
  }
  add_pose(transform, received_s);
  return true;
}

auto ScanAssembler::pose_taker() {
  return [this](const Odometry& pose, double received_s, bool has_stamp) {
    if (!has_stamp) warn_("odometry without stamp", "it gets the time when it was recorded");
    take_pose(pose, received_s);
  };
}

void ScanAssembler::add_pose(const TransformMessage& pose, double received_s) {
  if (base_.empty()) base_ = pose.child;
  odometry_frame_ = pose.parent;
  pose_stamps_.add({pose.stamp_s, seen_from_above(pose.T_parent_child)}, received_s, pose_taker());
}

void ScanAssembler::take_pose(const Odometry& pose, double received_s) {
  pose_clock_.add(received_s, pose.stamp_s, 0.0);
  ++poses_taken_;
  using Taken = OdometryTrack::Taken;
  const Taken taken = poses_.take(pose);
  if (taken == Taken::kPast) warn_("odometry steps back in time", "it is left out");
  if (taken == Taken::kForgot) warn_("odometry far ahead in time", "it is left out");
  if (taken != Taken::kSetBack) return;
  warn_("odometry's clock was set back", fmt::format("from {:.6f} s to {:.6f} s; scans get the poses of their side",
                                                     poses_.last_before_set_back_s(), poses_.first_after_set_back_s()));
  place_held_scans();
}

// A scan that waits while the clock is set back belongs to the nearer side of the step.
void ScanAssembler::place_held_scans() {
  for (Held& held : waiting_) {
    auto* const scan = std::get_if<HeldScan>(&held);
    if (scan == nullptr) continue;
    const double stamp_s = scan->scan.stamp_s - pose_shift_s_.value_or(0.0);
    const bool is_behind =
        std::fabs(stamp_s - poses_.first_after_set_back_s()) < std::fabs(stamp_s - poses_.last_before_set_back_s());
    if (is_behind) scan->stretch = poses_.stretch();
  }
}

auto ScanAssembler::crank_taker() {
  return [this](const WaitingStamp& known, double received_s, bool /*has_stamp*/) {
    known.number->stamp_s = known.stamp_s;
    crank_clock_.add(received_s, known.stamp_s, 0.0);
  };
}

void ScanAssembler::add_crank(const NumberMessage& number, double received_s, bool has_header) {
  waiting_.emplace_back(number);
  auto& waiting = std::get<NumberMessage>(waiting_.back());
  if (!has_header) return crank_taker()({received_s, &waiting}, received_s, false);
  crank_stamps_.add({number.stamp_s, &waiting}, received_s, crank_taker());
}

void ScanAssembler::settle_stamps() {
  pose_stamps_.settle(pose_taker());
  crank_stamps_.settle(crank_taker());
  for (std::size_t laser = 0; laser < lasers_.size(); ++laser) lasers_[laser].stamps.settle(scan_taker(laser));
}

// Equal clocks need no waiting. The difference of two clocks is known better, the more was received.
bool ScanAssembler::is_clock_known(bool must_go) {
  const auto settle = [&](std::optional<double>& shift_s, const TopicClock& clock, std::string_view what) {
    if (shift_s || !clock.is_known()) return true;
    if (options_.clock_offset_s) {
      shift_s = options_.clock_offset_s;
    } else if (!scan_clock_.is_known()) {
      return must_go;
    } else {
      const double apart_s = clock.offset_s() - scan_clock_.offset_s();
      if (std::fabs(apart_s) > TopicClock::kMostDelay_s && !must_go) return false;
      shift_s = measure_shift(clock, what);
    }
    return true;
  };
  const bool is_pose_clock_known = settle(pose_shift_s_, pose_clock_, "odometry");
  return settle(crank_shift_s_, crank_clock_, "the crank") && is_pose_clock_known;
}

double ScanAssembler::measure_shift(const TopicClock& clock, std::string_view what) {
  const double apart_s = clock.offset_s() - scan_clock_.offset_s();
  if (std::fabs(apart_s) <= TopicClock::kMostDelay_s) return 0.0;
  warn_("clocks differ", fmt::format("by when they were received, the stamps of {} are moved by {:.6f} s into the "
                                     "laser's clock; log.clock=stated says better",
                                     what, apart_s));
  return apart_s;
}

// Interpolates along the circular arc between the poses around the stamp; none before the first, the last pose after
// it.
std::optional<Pose2> ScanAssembler::odometry_at(std::uint64_t stretch, double stamp_s) const {
  const auto [before, after] = poses_.around(stretch, stamp_s);
  if (after == nullptr) return before == nullptr ? std::nullopt : std::optional(before->T_odom_base);
  if (after->stamp_s == stamp_s || before == after) return after->T_odom_base;
  if (before == nullptr) return std::nullopt;
  const double share = (stamp_s - before->stamp_s) / (after->stamp_s - before->stamp_s);
  return before->T_odom_base * exp_se2(share * log_se2(between(before->T_odom_base, after->T_odom_base)));
}

// The transforms of the mount may follow some messages after the first scan.
bool ScanAssembler::is_complete(const HeldScan& held) const {
  const double stamp_s = held.scan.stamp_s;
  if (source_ == PoseSource::kUnknown || poses_.empty()) return false;
  if (poses_.is_in_doubt() || poses_taken_ < held.due) return false;
  if (!poses_.is_known(held.stretch, stamp_s - pose_shift_s_.value_or(0.0))) return false;
  const std::string& frame = held.scan.frame;
  if (!lasers_[held.laser].T_base_laser && !mounts_.contains(frame) && !frames_.find(frame, base_)) return false;
  if (lasers_.size() < options_.topics.scans.size()) return false;
  return std::all_of(lasers_.begin(), lasers_.end(), [&](const Laser& other) { return other.last_stamp_s >= stamp_s; });
}

// An upside-down laser is also level.
void ScanAssembler::warn_of_tilt(const std::string& frame, const Transform3& mount) {
  const double sine = std::sqrt(mount.rotation[6] * mount.rotation[6] + mount.rotation[7] * mount.rotation[7]);
  if (sine <= kLevelSine) return;
  warn_("laser is not level", fmt::format("frame {} is tilted by {:.1f} degrees, and its scans are taken as level",
                                          in_quotes(frame), deg_from_rad(atan2(sine, std::fabs(mount.rotation[8])))));
}

const Transform3& ScanAssembler::find_mount(const std::string& frame) {
  if (const auto known = mounts_.find(frame); known != mounts_.end()) return known->second;
  std::optional<Transform3> mount = frames_.find(frame, base_);
  if (!mount) mount = frames_.find(frame, "");
  if (mount) warn_of_tilt(frame, *mount);
  if (mounts_.size() >= FrameTree::kMostFrames) {
    mounts_.clear();
    frames_without_mount_.clear();
  }
  if (mount) return mounts_.emplace(frame, *mount).first->second;
  frames_without_mount_.insert(frame);
  return mounts_.emplace(frame, Transform3()).first->second;
}

LaserContents ScanAssembler::laser_contents(std::size_t laser) const {
  const Laser& known = lasers_[laser];
  LaserContents contents{.topic = "", .frame = known.frame, .chain = frames_.chain(known.frame, base_)};
  if (contents.chain.empty()) contents.chain = frames_.chain(known.frame, "");
  if (known.T_base_laser) {
    contents.mount = MountSource::kStated;
  } else if (frames_without_mount_.contains(known.frame)) {
    contents.chain.clear();  // it came too late
  } else if (!contents.chain.empty()) {
    contents.mount = MountSource::kFrames;
  }
  return contents;
}

ScanRecord ScanAssembler::make_record(HeldScan held) {
  ScanMessage& scan = held.scan;
  const std::optional<Pose2>& stated = lasers_[held.laser].T_base_laser;
  if (!stated && !mounts_.contains(scan.frame) && !frames_.find(scan.frame, base_) && !frames_.find(scan.frame, "")) {
    warn_("laser mount unknown",
          fmt::format("no transform leads from frame {} to {} (frames: {}); it is taken as the robot's own frame: "
                      "--mount x,y,yaw (or log.mount) says better",
                      in_quotes(scan.frame), base_.empty() ? "a base_link" : in_quotes(base_), frames_.text()));
  }
  const Transform3& mount = find_mount(scan.frame);
  ScanRecord record;
  record.laser = held.laser;
  record.scan.stamp_s = scan.stamp_s;
  record.scan.first_bearing_rad = options_.first_bearing_rad.value_or(scan.first_bearing_rad);
  record.scan.bearing_step_rad = options_.bearing_step_rad.value_or(scan.bearing_step_rad);
  const bool has_limit = std::isfinite(scan.max_range_m) && scan.max_range_m > 0.0;
  record.scan.max_range_m = options_.max_range_m.value_or(has_limit ? scan.max_range_m : 0.0);
  record.scan.beam_period_s = sweep_s(scan) > 0.0 ? scan.beam_period_s : 0.0;
  record.scan.ranges_m = std::move(scan.ranges_m);
  clear_missing_ranges(record.scan.ranges_m, scan.min_range_m);
  record.scan.T_base_laser = stated.value_or(seen_from_above(mount));
  const bool are_stated = options_.bearing_step_rad.has_value();
  if (!are_stated) turn_right_to_left(record.scan, mount.rotation[8] < 0.0);
  record.T_odom_base = odometry_at(held.stretch, scan.stamp_s - pose_shift_s_.value_or(0.0));
  return record;
}

LogRecord ScanAssembler::make_record(const NumberMessage& number) const {
  const CrankOptions& crank = options_.crank;
  const double stamp_s = number.stamp_s + crank_shift_s_.value_or(0.0);
  if (crank.kind == CrankKind::kTilt) {
    const double step_rad = crank.step_rad == 0.0 ? 1.0 : crank.step_rad;
    return Tilt{.stamp_s = stamp_s, .elevation_rad = (number.value - crank.zero) * step_rad};
  }
  if (number.whole) return Encoder{.stamp_s = stamp_s, .ticks = *number.whole};
  const double ticks = crank.step_rad == 0.0 ? number.value : number.value / crank.step_rad;
  return Encoder{.stamp_s = stamp_s, .ticks = static_cast<std::int64_t>(std::llround(ticks))};
}

std::optional<LogRecord> ScanAssembler::next(bool at_end) {
  const bool must_go = at_end || held_scans_ > kMostHeldScans || waiting_.size() > kMostHeldScans + kMostHeldNumbers;
  if (must_go) settle_stamps();
  if (waiting_.empty()) return std::nullopt;
  if (!must_go && !scan_clock_.is_known()) return std::nullopt;
  if (!is_clock_known(must_go)) return std::nullopt;
  if (const auto* const number = std::get_if<NumberMessage>(&waiting_.front())) {
    if (crank_stamps_.is_waiting()) return std::nullopt;  // for this one, if it is the first
    const LogRecord record = make_record(*number);
    waiting_.pop_front();
    return record;
  }
  auto& held = std::get<HeldScan>(waiting_.front());
  if (!must_go && !is_complete(held)) return std::nullopt;
  if (source_ == PoseSource::kUnknown && !poses_.empty()) source_ = PoseSource::kTransforms;
  const double wanted_s = held.scan.stamp_s - pose_shift_s_.value_or(0.0);
  if (!poses_.empty() && held.stretch == poses_.stretch() && poses_.back().stamp_s < wanted_s) {
    warn_("scan after the last odometry", "it gets the last pose that is known");
  }
  HeldScan scan = std::move(held);
  waiting_.pop_front();
  --held_scans_;
  return make_record(std::move(scan));
}

}  // namespace gdtslam
