// Options, results and output of `gdtslam localize`.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "engine/io/atomic_file.hpp"
#include "engine/runs/localizer/localize_log.hpp"
#include "engine/runs/localizer/run.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/runs/settings.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam {

struct LocalizeOptions {
  std::string map;
  std::string log;
  ScanChoice choice;
  double gap_m = 0.005;
  double max_seconds = 0.0;  ///< 0: no limit
  bool no_runner_up = false;
  double poor_fit_m = -1.0;  ///< negative: the map's limit
  bool strict = false;
  DeviceOptions device{.device = "cpu"};
  bool lenient = false;
  RecordingOptions recording;
  bool force = false;
  bool json = false;
  bool quiet = false;
  bool track = false;
  std::string table;       ///< file to write; empty: none
  std::string changes;     ///< picture of --track
  std::string trajectory;  ///< file to write; empty: none
  std::string picture;
  SettingsOptions settings;
};

/// Limits of each search from the options.
LocalizeLimits search_limits(const LocalizeOptions& options);

/// Runs work(device options), and again on the CPU if the device fails. The CPU gives the same result, so a failing
/// device costs only the time spent. Throws like work().
template <class Work>
auto with_device(const DeviceOptions& device, const Work& work) {
  try {
    return work(device);
  } catch (const DeviceError& error) {
    if (device.no_fallback) throw;
    print_remark(fmt::format("warning: {}; beginning again with the CPU", error.what()));
  } catch (const InputError&) {
    if (!interrupted()) throw;  // else the signal ended the standard input
    throw Error(ExitCode::kInterrupted, "interrupted before the first scan; nothing is written");
  }
  DeviceOptions cpu = device;
  cpu.device = "cpu";
  return work(cpu);
}

// Output of `gdtslam localize`: text and a picture for people, JSON for programs. Everything except the JSON's "times"
// depends on the input alone. Thread-safe; O(scans), a picture O(cells).

struct LocalizeTimes {
  double wall_s = 0.0;
  double cpu_s = 0.0;  ///< CPU time of all threads
  std::string device{};
};

std::string as_text(const Localizer& localizer, const Localized& all);
std::string as_text(const Localizer& localizer, const TrackedDrive& drive);
nlohmann::ordered_json as_json(const LocalizeJob& job, const Localizer& localizer, const Localized& all,
                               const LocalizeTimes& times);
nlohmann::ordered_json as_json(const LocalizeJob& job, const Localizer& localizer, const TrackedDrive& drive,
                               const LocalizeTimes& times);

/// "196 found, 4 ambiguous, 0 poor fit"; also scans without a pose if there are any.
std::string verdicts_text(const std::vector<LocalizedScan>& scans);

/// Scans on their map, each as an arrow; for a tracked robot its path.
Canvas localize_picture(const std::string& log, const Localizer& localizer, const Localized& all);
Canvas localize_picture(const std::string& log, const Localizer& localizer, const TrackedDrive& drive);

/// Writes the requested files: poses, table, picture. `Found` is Localized or TrackedDrive.
template <class Found>
void write_results(const LocalizeOptions& options, const Localizer& localizer, const Found& found,
                   const Trajectory& trajectory, const std::string& table) {
  if (!options.trajectory.empty()) write_tum(options.trajectory, trajectory);
  if (!options.table.empty()) write_file_atomically(options.table, table);
  if (options.picture.empty()) return;
  write_file_atomically(options.picture,
                        drawing_bytes(localize_picture(options.log, localizer, found), options.picture));
}

template <class Found>
void print_remarks(const Found& found) {
  print_warnings(found.warnings);
  if (found.nods) {
    print_remark("warning: the laser of this log nods; a scan is found where it was taken nearly level only");
  }
  if (found.interrupted) print_remark("interrupted after " + plural(found.scans.size(), "scan"));
}

/// Table beside the picture of --changes: "office.csv" for "office.png".
std::string changes_table_file(const std::string& picture);

// `gdtslam localize --track`: follows a robot through a log in a fixed map.

/// Tracks, writes the files, prints; returns the exit code.
int track(const LocalizeOptions& options, const Settings& settings, const LocalizeJob& job);

}  // namespace gdtslam
