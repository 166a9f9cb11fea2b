// Options of `gdtslam live` and its two modes: mapping, and following in a fixed map.
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
  std::string listen;  ///< an address to listen at; it and `follow` replace `log`
  std::string follow;  ///< a file that grows
  std::uint64_t queue = 0;
  std::string map;     ///< a map that stays as it is; empty: a new one is made
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

/// Input of the drive; null if the log is read by its name, without a queue.
std::shared_ptr<LiveInput> open_input(const DriveOptions& options);
/// Name of the input in messages and in the folder's name.
std::string input_name(const DriveOptions& options);
LineOutput::Rule output_rule(const DriveOptions& options);
/// The page, whose address is printed on standard error; null if no page was requested.
std::unique_ptr<LivePage> open_live_page(const DriveOptions& options);

/// Prints advice for a nodding laser if one of these warnings is about it.
void print_remark_on_nods(const std::vector<LogReader::Warning>& warnings);

/// Both return the exit code.
int map_live(const DriveOptions& options);
int follow_live(const DriveOptions& options);

}  // namespace gdtslam
