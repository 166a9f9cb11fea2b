// The simulated drives that parts share: a log with its truth and, where it is mapped, the run, in DIR/work/NAME. Each
// is made when a part asks for it and once. One object belongs to one thread.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "device_option.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "reproduce_part.hpp"

namespace gdtslam::reproduce {

struct DriveRecipe {
  std::string_view name;
  std::string_view scene;
  std::string_view waypoints;     ///< of a trajectory file; empty: those of the scene
  std::vector<std::string> sets;  ///< of the map, as --set has them
  bool is_mapped = true;
};
const DriveRecipe& recipe_of(std::string_view name);

struct Drive {
  std::string log;
  std::string truth;
  std::string run;    ///< folder; empty: not mapped
  std::string scene;  ///< file
};

class Drives {
 public:
  /// `program` stands for the program: what another one left is not used.
  Drives(std::string folder, std::string program, DeviceOptions device, std::function<bool()> stop);

  /// Simulates and maps where that is not done. Throws as simulate() and map_log(), Error(kInterrupted).
  Drive drive(std::string_view name, const std::function<void(double)>& progress);
  /// What stands for all that goes into it: scene, waypoints, options.
  [[nodiscard]] static std::string key_of(std::string_view name);
  /// `gdtslam simulate ...` and `gdtslam map ...`.
  [[nodiscard]] static std::vector<std::string> commands_of(std::string_view name);

 private:
  std::string folder_;
  std::string program_;
  DeviceOptions device_;
  std::function<bool()> stop_;
};

inline constexpr std::uint64_t kSeed = 1;

/// Errors of a run against the truth of its drive, aligned.
ReferenceReport errors_of(const Drive& drive);

/// Text of a file. Throws FileError.
std::string text_of_file(const std::string& path);

}  // namespace gdtslam::reproduce
