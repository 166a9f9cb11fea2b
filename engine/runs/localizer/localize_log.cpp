#include "localize_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "engine/core/worker_pool.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/localizer/map_field.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/map_files.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kBatchPerThread = 4;

struct ChosenScan {
  std::uint64_t index = 0;
  LaserScan scan;
};

/// Reads the chosen scans in order.
class ScanSource {
 public:
  explicit ScanSource(const LocalizeJob& job)
      : choice_(job.choice),
        index_(job.choice.first),
        stream_({job.log}, job.read, {.skip = job.choice.first, .count = std::numeric_limits<std::uint64_t>::max()}) {}

  std::optional<ChosenScan> next() {
    if (choice_.every == 0 && index_ > choice_.first) return std::nullopt;
    for (std::optional<ScanRecord> record = stream_.next(); record; record = stream_.next()) {
      const std::uint64_t index = index_++;
      if (choice_.every == 0 || (index - choice_.first) % choice_.every == 0) {
        return ChosenScan{index, std::move(record->scan)};
      }
    }
    return std::nullopt;
  }
  ScanStream& stream() { return stream_; }

 private:
  ScanChoice choice_;
  std::uint64_t index_;
  ScanStream stream_;
};

// A signal leaves out only the last scans, none in between.
void localize_batch(const std::vector<ChosenScan>& batch, const Localizer& localizer, WorkerPool& pool,
                    const std::function<bool()>& stop, std::vector<LocalizedScan>& scans) {
  std::vector<std::optional<LocalizedScan>> found(batch.size());
  pool.run(batch.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t k = begin; k < end && !stop(); ++k) {
      found[k] = localizer.localize(batch[k].scan, batch[k].index);
    }
  });
  for (std::size_t k = 0; k < found.size() && found[k]; ++k) scans.push_back(*found[k]);
}

}  // namespace

Localized localize_scans(const LocalizeJob& job, const Localizer& localizer, const LocalizeProgress& progress,
                         const std::function<bool()>& stop) {
  Localized all;
  ScanSource source(job);
  all.nods = source.stream().nod_kind() != NodKind::kNone;
  WorkerPool pool(localizer.has_device() ? 1 : job.threads);
  const std::size_t most = kBatchPerThread * pool.threads();
  std::vector<ChosenScan> batch;
  do {
    batch.clear();
    while (batch.size() < most && !stop()) {
      std::optional<ChosenScan> scan = next_unless_stopped(source, stop);
      if (!scan) break;
      batch.push_back(std::move(*scan));
    }
    localize_batch(batch, localizer, pool, stop, all.scans);
    progress(all.scans.size(), job.choice.every == 0 ? -1.0 : source.stream().progress());
  } while (batch.size() == most && !stop());
  all.interrupted = stop();
  all.warnings = source.stream().warnings();
  if (!all.scans.empty() || all.interrupted) return all;
  const std::uint64_t read = source.stream().scans_read();
  throw InputError({job.log, 0}, read == 0 ? std::string("holds no laser scan")
                                           : fmt::format("has no scan {}: {} were read", job.choice.first, read));
}

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

std::string json_name(Verdict verdict) {
  std::string name(to_string(verdict));
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string table_text(const std::vector<LocalizedScan>& scans) {
  std::string text =
      "scan,stamp_s,verdict,ambiguous,x_m,y_m,theta_rad,points,mean_distance_m,mean_bound_m,proven,elsewhere_x_m,"
      "elsewhere_y_m,elsewhere_theta_rad,elsewhere_mean_distance_m\n";
  const auto out = std::back_inserter(text);
  for (const LocalizedScan& scan : scans) {
    fmt::format_to(out, "{},{:.9f},{},{}", scan.index, scan.stamp_s, json_name(scan.verdict),
                   scan.is_ambiguous() ? 1 : 0);
    if (scan.best) {
      const Pose2& T = scan.best->T_map_base;
      fmt::format_to(out, ",{:.6f},{:.6f},{:.8f},{},{:.5f},{:.5f},{}", T.x_m, T.y_m, T.theta_rad, scan.points,
                     scan.best->mean_cost_m, scan.best->mean_bound_m, scan.is_proven() ? 1 : 0);
    } else {
      fmt::format_to(out, ",,,,{},,,0", scan.points);
    }
    if (scan.runner_up && scan.runner_up->stop != CertifiedStop::kNothingAllowed) {
      const Pose2& T = scan.runner_up->T_map_base;
      fmt::format_to(out, ",{:.6f},{:.6f},{:.8f},{:.5f}\n", T.x_m, T.y_m, T.theta_rad, scan.runner_up->mean_cost_m);
    } else {
      fmt::format_to(out, ",,,,\n");
    }
  }
  return text;
}

std::string table_text(const TrackedDrive& drive) {
  std::string text =
      "scan,stamp_s,whereabouts,ambiguous,x_m,y_m,theta_rad,xx_m2,xy_m2,xt_m_rad,yy_m2,yt_m_rad,tt_rad2,explained,"
      "mean_distance_m\n";
  const auto out = std::back_inserter(text);
  for (const TrackedScan& scan : drive.scans) {
    const TrackedPose& pose = scan.pose;
    fmt::format_to(out, "{},{:.9f},{},{}", scan.index, scan.stamp_s, to_string(pose.whereabouts),
                   pose.is_ambiguous ? 1 : 0);
    if (pose.whereabouts == Whereabouts::kUnknown) {
      fmt::format_to(out, ",,,,,,,,,,,\n");
      continue;
    }
    const Pose2& T = pose.T_map_base;
    const PoseCovariance& c = pose.covariance;
    fmt::format_to(out, ",{:.6f},{:.6f},{:.8f},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.4f},{:.5f}\n", T.x_m, T.y_m,
                   T.theta_rad, c.xx, c.xy, c.xt, c.yy, c.yt, c.tt, pose.explained, pose.mean_distance_m);
  }
  return text;
}

std::array<std::uint64_t, kVerdicts.size()> count_verdicts(const std::vector<LocalizedScan>& scans) {
  std::array<std::uint64_t, kVerdicts.size()> counts{};
  for (const LocalizedScan& scan : scans) ++counts.at(static_cast<std::size_t>(scan.verdict));
  return counts;
}

std::array<std::uint64_t, kWhereabouts.size()> count_whereabouts(const TrackedDrive& drive) {
  std::array<std::uint64_t, kWhereabouts.size()> counts{};
  for (const TrackedScan& scan : drive.scans) ++counts.at(static_cast<std::size_t>(scan.pose.whereabouts));
  return counts;
}

namespace {

// The free and occupied cells of the field's map.
OccupancyMap read_cells(const MapField& field) {
  if (field.source == MapField::Source::kOccupiedCells) return read_occupancy_map(field.path);
  if (field.run && field.run->summary().map) return field.run->map();
  const std::filesystem::path file = std::filesystem::path(field.path).parent_path() / "map.yaml";
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    throw InputError({field.path, 0},
                     "has no map.yaml beside it, which says what is free: changes cannot be told; map the log again "
                     "without --no-map");
  }
  return read_occupancy_map(file.string());
}

ViewCounts views_in(const OccupancyMap& map, const MapperConfig& config, const ChangeLimits& limits) {
  return ViewCounts({.rays = {.resolution_m = map.geometry.resolution_m,
                              .min_range_m = config.scan.min_range_m,
                              .max_range_m = config.scan.max_range_m,
                              .short_of_end_m = limits.tolerance_m},
                     .spacing_m = limits.spacing_m,
                     .max_cells = static_cast<std::uint64_t>(config.map.max_megacells) << 20U});
}

void add_rows(const GridGeometry& grid, const std::vector<ChangedCell>& cells, const char* change, std::string& text) {
  for (const ChangedCell& changed : cells) {
    const Point2 at_m = grid.cell_centre(changed.cell);
    text += fmt::format("{:.4f},{:.4f},{},{},{},{}\n", at_m.x(), at_m.y(), change, changed.patch + 1,
                        changed.views.ends, changed.views.passes);
  }
}

}  // namespace

DriveChanges::DriveChanges(const MapField& field, const MapperConfig& config, const ChangeLimits& limits)
    : map_(read_cells(field)), limits_(limits), views_(views_in(map_, config, limits)) {
  see_what_was_before(field, config);
}

void DriveChanges::see_what_was_before(const MapField& field, const MapperConfig& config) {
  const std::optional<std::string> folder = find_run_folder(field.path);
  if (field.source == MapField::Source::kOccupiedCells || !folder) return;
  const std::optional<RunKeyframes> kept = (field.run ? *field.run : RunReader(*folder)).keyframes();
  if (!kept) return;
  before_.emplace(views_in(map_, config, limits_));
  for (const RunKeyframe& keyframe : kept->keyframes) before_->add(keyframe.laser, in_grid(keyframe.T_map_base));
}

Pose2 DriveChanges::in_grid(const Pose2& T_map_base) const {
  return {T_map_base.x_m - map_.geometry.origin_x_m, T_map_base.y_m - map_.geometry.origin_y_m, T_map_base.theta_rad};
}

void DriveChanges::see(const LaserScan& scan, const TrackedPose& pose) {
  const bool is_sure = pose.whereabouts == Whereabouts::kTracked && !pose.is_ambiguous;
  if (is_sure) {
    if (!is_seeing_) stretches_.emplace_back();
    stretches_.back().push_back({scan.stamp_s, pose.T_map_base});
    views_.add(scan, in_grid(pose.T_map_base));
  }
  is_seeing_ = is_sure;
}

std::string changes_table(const GridGeometry& grid, const MapChanges& changes) {
  std::string text = "x_m,y_m,change,place,ended,passed\n";
  add_rows(grid, changes.appeared, "new", text);
  add_rows(grid, changes.gone, "gone", text);
  return text;
}

}  // namespace gdtslam
