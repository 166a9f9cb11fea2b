// What the command line of `gdtslam localize` asks for.
#pragma once

#include <fmt/format.h>

#include <string>

#include "engine/runs/localizer/run.hpp"
#include "engine/runs/localizer/scans.hpp"
#include "gdtslam/core/error.hpp"
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
  double poor_fit_m = -1.0;  ///< negative: what the map tells
  bool strict = false;
  DeviceOptions device{.device = "cpu"};
  bool lenient = false;
  RecordingOptions recording;
  bool force = false;
  bool json = false;
  bool quiet = false;
  bool track = false;
  std::string table;       ///< to be written; empty: none
  std::string changes;     ///< of --track, the picture
  std::string trajectory;  ///< to be written; empty: none
  std::string picture;
  SettingsOptions settings;
};

/// Limits of each search, as the options say.
LocalizeLimits limits_of(const LocalizeOptions& options);

/// Does work(device options), and again with the CPU where the device fails: the CPU gives the same, so a device that
/// fails costs the time spent and nothing else. Throws what work() throws.
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

}  // namespace gdtslam
