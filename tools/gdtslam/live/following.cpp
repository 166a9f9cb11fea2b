// A drive in an existing map that stays as it is.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <memory>
#include <string>

#include "engine/runs/localizer/localize_log.hpp"
#include "gdtslam/core/error.hpp"
#include "input/live_input.hpp"
#include "options.hpp"
#include "page/page_figures.hpp"
#include "snapshot/snapshots.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

LocalizeJob make_job(const DriveOptions& options, const Settings& settings) {
  LogConfig log = settings.log;
  state_recording(options.recording, log);
  LocalizeJob job;
  job.log = input_name(options);
  job.read = read_options_of(log, options.lenient);
  auto input = open_input(options);
  if (!input) input = open_stream(options.log);
  job.live_log = make_live_log(std::move(input), options.queue);
  return job;
}

using WhereaboutsCounts = std::array<std::uint64_t, kWhereabouts.size()>;

std::string counts_text(const WhereaboutsCounts& counts) {
  std::string text;
  for (const Whereabouts whereabouts : kWhereabouts) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", counts.at(static_cast<std::size_t>(whereabouts)),
                        to_string(whereabouts));
  }
  return text;
}

/// Prints each pose, counts it and shows it.
class FollowedDrive {
 public:
  FollowedDrive(const DriveOptions& options, const ScanConfig& valid, LineOutput& output, LivePage* page)
      : format_(parse_pose_format(options.format)), valid_(valid), output_(output), page_(page) {}

  void take(const LaserScan& laser, const TrackedPose& pose) {
    output_.write(pose_line(format_, counts_.scans, laser.stamp_s, pose));
    ++counts_.scans;
    ++whereabouts_.at(static_cast<std::size_t>(pose.whereabouts));
    counts_.scans_per_s = meter_.count();
    const bool is_known = pose.whereabouts != Whereabouts::kUnknown;
    if (is_known && T_map_last_) counts_.path_m += (pose.T_map_base.translation() - T_map_last_->translation()).norm();
    T_map_last_ = is_known ? std::optional(pose.T_map_base) : std::nullopt;
    if (page_ != nullptr) page_->show(shown_scan(counts_, valid_, laser, pose));
  }

  [[nodiscard]] std::uint64_t scans() const { return counts_.scans; }
  [[nodiscard]] std::string text() const { return plural(counts_.scans, "scan") + ": " + counts_text(whereabouts_); }

 private:
  PoseFormat format_;
  ScanConfig valid_;
  LineOutput& output_;
  LivePage* page_;
  DriveCounts counts_;
  WhereaboutsCounts whereabouts_{};
  RateMeter meter_;
  std::optional<Pose2> T_map_last_;
};

}  // namespace

int follow_live(const DriveOptions& options) {
  let_signal_save();  // SIGUSR1 must not end the process, though there is no snapshot to save
  const Settings settings = load_settings(options.settings);
  const LocalizeJob job = make_job(options, settings);
  DeviceOptions device = options.device;
  device.threads = 1;
  const std::unique_ptr<Backend> backend = make_backend(device);
  device.device = "cpu";
  const std::unique_ptr<Backend> cpu = make_backend(device);
  const Localizer localizer(options.map, settings.mapper, {}, *backend);
  LineOutput output(output_rule(options));
  const std::unique_ptr<LivePage> page = open_live_page(options);
  if (page) page->show(shown_map(localizer.field()), {});
  FollowedDrive drive(options, settings.mapper.scan, output, page.get());
  std::vector<LogReader::Warning> warnings;
  std::exception_ptr problem;
  try {
    warnings = track_drive(
                   job, localizer, settings.mapper, *cpu, [](std::uint64_t, double) {},
                   [&] { return interrupted() || output.has_failed(); },
                   [&](const LaserScan& laser, const TrackedPose& pose) { drive.take(laser, pose); })
                   .warnings;
  } catch (const Error&) {
    problem = std::current_exception();
  }
  output.finish();  // the poses so far are printed even after an error
  if (!options.quiet && (!problem || drive.scans() > 0)) {
    print_warnings(warnings);
    print_remark_on_nods(warnings);
    print_remark(drive.text());
  }
  if (problem) std::rethrow_exception(problem);
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace gdtslam
