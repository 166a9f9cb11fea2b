#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "engine/drawing/maps/map_pictures.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/drive/stopwatch.hpp"
#include "engine/runs/localizer/localize_log.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/localize/localize.hpp"
#include "tools/gdtslam/shell/commands.hpp"

namespace gdtslam {
namespace {

ChangesLayer make_layer(const std::vector<ChangedCell>& cells) {
  ChangesLayer layer;
  layer.cells.reserve(cells.size());
  for (const ChangedCell& changed : cells) layer.cells.push_back({changed.cell, changed.patch});
  layer.patches = static_cast<std::uint32_t>(count_patches(cells));
  return layer;
}

double area_m2(const DriveChanges& seen, const std::vector<ChangedCell>& cells) {
  const double r = seen.map().geometry.resolution_m;
  return r * r * static_cast<double>(cells.size());
}

nlohmann::ordered_json cells_json(const DriveChanges& seen, const std::vector<ChangedCell>& cells) {
  return {{"places", count_patches(cells)}, {"cells", cells.size()}, {"area_m2", area_m2(seen, cells)}};
}

PictureSize picture_size(const OccupancyMap& map) { return size_for_content(map.geometry.width, map.geometry.height); }

void write_changes(const std::string& picture, const LocalizeJob& job, const DriveChanges& seen,
                   const MapChanges& changes) {
  MapLook look;
  look.title = "What changed in the map, as " + std::filesystem::path(job.log).filename().string() + " shows it";
  look.subtitle = fmt::format(
      "{} views from {:g} cm apart; new: at least {} of them end there, gone: as many pass through; away from walls by "
      "{:g} cm",
      seen.views(), 100.0 * seen.limits().spacing_m, seen.limits().least_views, 100.0 * seen.limits().tolerance_m);
  const ChangesOverlay overlay{make_layer(changes.appeared), make_layer(changes.gone), seen.stretches()};
  write_file_atomically(picture,
                        drawing_bytes(changes_picture(seen.map(), overlay, look, picture_size(seen.map())), picture));
  write_file_atomically(changes_table_file(picture), changes_table(seen.map().geometry, changes));
}

std::string as_text(const DriveChanges& seen, const MapChanges& changes) {
  const auto part = [](const char* what, const std::vector<ChangedCell>& cells) {
    const std::size_t places = count_patches(cells);
    return fmt::format("{} in {} place{}, {} cells", what, places, places == 1 ? "" : "s", cells.size());
  };
  return fmt::format("changes by {} views: {}; {}\n", seen.views(), part("new", changes.appeared),
                     part("gone", changes.gone));
}

nlohmann::ordered_json as_json(const DriveChanges& seen, const MapChanges& changes) {
  return {{"views", seen.views()},
          {"tolerance_m", seen.limits().tolerance_m},
          {"least_views", seen.limits().least_views},
          {"new", cells_json(seen, changes.appeared)},
          {"gone", cells_json(seen, changes.gone)}};
}

struct TrackWork {
  std::unique_ptr<Backend> backend;
  std::unique_ptr<Backend> cpu;  // tracks, whatever device searches
  std::unique_ptr<Localizer> localizer;
  TrackedDrive drive;
  std::unique_ptr<DriveChanges> changes;  // null unless requested
  MapChanges found;
};

// Scans are tracked one after the other, and their kernels are too short for threads.
TrackWork track_with(const LocalizeOptions& options, const Settings& settings, const LocalizeJob& job,
                     DeviceOptions device) {
  device.threads = 1;
  TrackWork work;
  work.backend = make_backend(device);
  device.device = "cpu";
  work.cpu = make_backend(device);
  work.localizer = std::make_unique<Localizer>(options.map, settings.mapper, search_limits(options), *work.backend);
  if (!options.changes.empty()) {
    work.changes = std::make_unique<DriveChanges>(work.localizer->field(), settings.mapper, ChangeLimits{});
  }
  ProgressLine progress("scans", options.quiet);
  work.drive = track_drive(
      job, *work.localizer, settings.mapper, *work.cpu,
      [&progress](std::uint64_t scans, double share) { progress.update(scans, share); }, [] { return interrupted(); },
      [&work](const LaserScan& scan, const TrackedPose& pose) {
        if (work.changes) work.changes->see(scan, pose);
      });
  if (work.changes) work.found = work.changes->found();
  return work;
}

Trajectory tracked_poses(const TrackedDrive& drive) {
  Trajectory trajectory;
  trajectory.reserve(drive.scans.size());
  for (const TrackedScan& scan : drive.scans) {
    if (scan.pose.whereabouts != Whereabouts::kUnknown) trajectory.push_back({scan.stamp_s, scan.pose.T_map_base});
  }
  return trajectory;
}

void require_known(const TrackedDrive& drive, std::uint64_t unknown) {
  const auto ambiguous = std::count_if(drive.scans.begin(), drive.scans.end(),
                                       [](const TrackedScan& scan) { return scan.pose.is_ambiguous; });
  if (unknown == 0 && ambiguous == 0) return;
  throw Error(ExitCode::kFailed,
              fmt::format("--strict: the place of {} scans is not known, that of {} is ambiguous", unknown, ambiguous));
}

}  // namespace

std::string changes_table_file(const std::string& picture) {
  return std::filesystem::path(picture).replace_extension(".csv").string();
}

int track(const LocalizeOptions& options, const Settings& settings, const LocalizeJob& job) {
  Stopwatch watch;
  LocalizeTimes times;
  const TrackWork work = with_device(
      options.device, [&](const DeviceOptions& device) { return track_with(options, settings, job, device); });
  const TrackedDrive& drive = work.drive;
  watch.add_to(times.wall_s, times.cpu_s);
  write_results(options, *work.localizer, drive, tracked_poses(drive), table_text(drive));
  if (work.changes) write_changes(options.changes, job, *work.changes, work.found);
  print_remarks(drive);
  if (options.json) {
    times.device = work.backend->device().name;
    nlohmann::ordered_json report = as_json(job, *work.localizer, drive, times);
    if (work.changes) report["changes"] = as_json(*work.changes, work.found);
    print_result(json_text(report));
  } else if (!options.quiet) {
    const std::string changes = work.changes ? as_text(*work.changes, work.found) : std::string();
    print_result(as_text(*work.localizer, drive) + changes);
  }
  if (drive.interrupted) return static_cast<int>(ExitCode::kInterrupted);
  const std::uint64_t unknown = count_whereabouts(drive).front();
  if (unknown == drive.scans.size()) {
    throw InputError({job.log, 0},
                     std::string("the robot was found at none of its scans; was it driven in the place of this map?") +
                         (options.max_seconds > 0.0 ? " Or --max-time is too short" : ""));
  }
  if (options.strict) require_known(drive, unknown);
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace gdtslam
