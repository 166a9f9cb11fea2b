#include "drive.hpp"

#include <fmt/format.h>

#include <limits>

#include "engine/runs/streams/next_unless_stopped.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

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
    const TrackedScan scan{.index = job.choice.first + drive.followed++,
                           .stamp_s = record->scan.stamp_s,
                           .pose = tracker.follow(record->scan, record->T_odom_base)};
    if (followed) followed(record->scan, scan.pose);
    if (!job.live_log) drive.scans.push_back(scan);
    progress(drive.followed, stream.progress());
  }
  drive.interrupted = stop();
  drive.searches = tracker.searches();
  drive.warnings = stream.warnings();
  if (drive.followed > 0 || drive.interrupted) return drive;
  throw InputError({job.log, 0}, stream.scans_read() == 0 ? std::string("holds no laser scan")
                                                          : fmt::format("has no scan {}: {} were read",
                                                                        job.choice.first, stream.scans_read()));
}

}  // namespace gdtslam
