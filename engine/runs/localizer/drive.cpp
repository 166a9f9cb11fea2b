#include "drive.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "engine/runs/streams/next_unless_stopped.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

TrackReference beside_reference(const Localizer& localizer, const LaserScan& scan, const Pose2& T_map_base,
                                const TrackedPose& pose) {
  TrackReference reference{.T_map_base = T_map_base, .known_share = localizer.known_share(scan, T_map_base)};
  reference.is_mapped = reference.known_share >= localizer.least_known_share();
  if (pose.whereabouts == Whereabouts::kUnknown) return reference;
  const LocalizeLimits& limits = localizer.limits();
  reference.distance_m = (pose.T_map_base.translation() - T_map_base.translation()).norm();
  reference.angle_rad = std::fabs(wrap_angle(pose.T_map_base.theta_rad - T_map_base.theta_rad));
  reference.is_within = reference.distance_m <= limits.within_m && reference.angle_rad <= limits.within_rad;
  return reference;
}

TrackedScan follow(RobotTracker& tracker, const ScanRecord& record) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  const std::uint64_t searches = tracker.searches();
  TrackedScan scan;
  scan.stamp_s = record.scan.stamp_s;
  scan.pose = tracker.follow(record.scan, record.T_odom_base);
  scan.is_searched = tracker.searches() != searches;
  scan.wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  return scan;
}

}  // namespace

TrackedDrive track_drive(const LocalizeJob& job, const Localizer& localizer, const MapperConfig& config, Backend& cpu,
                         const LocalizeProgress& progress, const std::function<bool()>& stop,
                         const ScanFollowed& followed) {
  TrackedDrive drive;
  RobotTracker tracker(localizer, config, cpu);
  ScanStream::OpenLog open;
  if (job.live_log) open = [&job](std::size_t) { return job.live_log(job.read); };
  ScanStream stream({job.log}, job.read, {.skip = job.choice.first, .count = std::numeric_limits<std::uint64_t>::max()},
                    open);
  drive.nods = !job.live_log && stream.nod_kind() != NodKind::kNone;
  while (!stop()) {
    const std::optional<ScanRecord> record = next_unless_stopped(stream, stop);
    if (!record) break;
    TrackedScan scan = follow(tracker, *record);
    if (followed) followed(record->scan, scan.pose);
    scan.index = job.choice.first + drive.followed++;
    const std::optional<Pose2> reference =
        job.reference ? job.reference->find(record->scan.stamp_s) : std::optional<Pose2>();
    if (reference) scan.reference = beside_reference(localizer, record->scan, *reference, scan.pose);
    if (!job.live_log) drive.scans.push_back(scan);
    progress(drive.followed, stream.progress());
  }
  drive.interrupted = stop();
  drive.warnings = stream.warnings();
  if (drive.followed > 0 || drive.interrupted) return drive;
  throw InputError({job.log, 0}, stream.scans_read() == 0 ? std::string("holds no laser scan")
                                                          : fmt::format("has no scan {}: {} were read",
                                                                        job.choice.first, stream.scans_read()));
}

}  // namespace gdtslam
