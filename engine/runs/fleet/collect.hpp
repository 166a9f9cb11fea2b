// Which logs a plan has: named files, those found in folders, those of a list. No log is opened; what it has is told by
// its name. Thread-safe; a look at each file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "plan.hpp"

namespace gdtslam {

/// Whether a file's name ends as those of logs do: .log, .clf, .csv, .jsonl, .bag, .mcap or .db3, each plain or packed
/// (.gz, .bz2, .xz, .zst).
bool has_name_of_a_log(std::string_view file);

/// A folder with metadata.yaml.
bool is_ros2_bag(const std::filesystem::path& folder);

/// What was found.
struct CollectedUnits {
  std::vector<FleetUnit> units;  ///< by URI, each once
  std::size_t twice = 0;         ///< named more than once
  std::size_t links = 0;         ///< in folders, of a log's name or to a folder: left out
};

class UnitCollector {
 public:
  /// A file, a ROS 2 bag (a folder with metadata.yaml), a folder to be searched with all below it, but for run folders,
  /// hidden ones and links; or an URI with a scheme. Throws FileError for what is not there, InputError for a folder
  /// without a log and for a name that is no UTF-8.
  void add(const std::string& log);
  /// A list: an URI a line, with a tab and its bytes where they are known; relative paths are relative to the working
  /// folder. Empty lines and those that begin with # count for nothing. A file's bytes are asked for where the list
  /// does not know them. Throws as add(), with the line; `name` stands in messages.
  void add_list(std::string_view text, const std::string& name);
  CollectedUnits take();

 private:
  void add_unit(std::string uri, std::uint64_t bytes);
  std::vector<FleetUnit> units_;
  std::size_t links_ = 0;
};

}  // namespace gdtslam
