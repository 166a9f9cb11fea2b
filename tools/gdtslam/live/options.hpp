// Options of `gdtslam live`, and its two ways to go: with a map that grows, and in one that stays.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "input/live_input.hpp"
#include "output/line_output.hpp"
#include "output/pose_lines.hpp"
#include "page/live_page.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam {

struct DriveOptions {
  std::string log = "-";
  std::string listen;  ///< an address to listen at, instead of `log`, as the next
  std::string follow;  ///< a file that grows
  std::uint64_t queue = 0;
  std::string map;     ///< that stays as it is; empty: one is made
  std::string folder;  ///< empty: runs/<log>-<UTC time>
  double snapshot_s = 0.0;
  std::string page;  ///< PORT or ADDRESS:PORT; empty: none
  std::string format = std::string(kPoseFormats.front());
  SettingsOptions settings;
  DeviceOptions device;
  RecordingOptions recording;
  bool lenient = false;
  bool force = false;
  bool no_map = false;
  bool no_pictures = false;
  bool no_loops = false;
  bool quiet = false;
};

/// Input of the drive: null if the log is read by its name, with nothing ahead.
std::shared_ptr<LiveInput> open_input(const DriveOptions& options);
/// Its name in messages and in the folder's.
std::string input_name(const DriveOptions& options);
LineOutput::Rule output_rule(const DriveOptions& options);
/// Null where none is asked for; where it is is said on standard error.
std::unique_ptr<LivePage> open_live_page(const DriveOptions& options);

/// Tells the user of a laser that nods what to do, if these warnings name one.
void print_remark_on_nods(const std::vector<LogReader::Warning>& warnings);

/// Both return the exit code.
int map_live(const DriveOptions& options);
int follow_live(const DriveOptions& options);

}  // namespace gdtslam
