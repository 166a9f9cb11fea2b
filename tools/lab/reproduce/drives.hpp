// The logs that parts work on. Simulated drives, which parts share: a log with its truth and, where it is mapped, the
// run, in a folder of its own among the output's working files; each is made when a part asks for it and once. And the
// real logs, which parts take in where they are there. One object belongs to one thread.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "part.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"

namespace gdtslam::reproduce {

struct DriveRecipe {
  std::string_view name;
  std::string_view scene;
  std::string_view waypoints{};     ///< of a trajectory file; empty: those of the scene
  std::vector<std::string> sets{};  ///< of the map, as --set has them
  bool is_mapped = true;
  bool with_loops = true;         ///< closed, which the paper's system does not do
  std::string_view laser = {};    ///< preset; empty: the scene's
  std::string_view linkage = {};  ///< the mount's; empty: the scene's
  std::uint64_t first = 0;        ///< scans that are mapped; 0: all
  std::uint64_t seed = 1;
  double weight_s = 1.0;  ///< CPU seconds as measured, for the time left
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

  [[nodiscard]] bool is_made(std::string_view name) const;
  /// Simulates and maps. Throws as simulate() and map_logs(), Error(kInterrupted).
  void make(std::string_view name, const std::function<void(double)>& progress) const;
  /// Throws FileError where a folder of somebody else has the drive's name.
  void require_own(std::string_view name) const;
  /// Makes the folder of all drives; before the first make().
  void prepare() const;
  /// What prepare() and make() made goes; what somebody else put beside it stays.
  void clear() const;
  /// Where a drive is that is made.
  [[nodiscard]] Drive drive(std::string_view name) const;
  /// What stands for all that goes into it: scene, waypoints, options.
  [[nodiscard]] static std::string key_of(std::string_view name);
  /// `gdtslam simulate ...` and `gdtslam map ...`.
  [[nodiscard]] static std::vector<std::string> commands_of(std::string_view name);

 private:
  [[nodiscard]] std::string folder_of(std::string_view name) const;
  [[nodiscard]] std::string mark_of(std::string_view name) const;
  void simulate_drive(const DriveRecipe& recipe, const Drive& drive, const std::string& folder,
                      const std::function<void(double)>& progress) const;

  std::string folder_;
  std::string program_;
  DeviceOptions device_;
  std::function<bool()> stop_;
};

inline constexpr std::uint64_t kSeed = 1;

/// Errors of a run against the truth of its drive: aligned, or with the first poses made to agree.
ReferenceReport errors_of(const Drive& drive, bool is_aligned = true);

/// How a log is mapped where it is not by the defaults.
struct MapChoices {
  std::vector<std::string> sets{};  ///< as --set has them
  std::uint64_t first = 0;          ///< scans; 0: all
  bool with_loops = true;
};
/// A log mapped into a folder. Throws as map_logs(), Error(kInterrupted).
void map_whole(const std::string& log, const std::string& run, const DeviceOptions& device,
               const std::function<void(double)>& progress, const MapChoices& choices = {});

struct RealLog {
  std::string name;       ///< "Intel Research Lab"
  std::string stem;       ///< "intel"
  std::string log;        ///< file
  std::string relations;  ///< file
};

/// Those of the folder (FOLDER or FOLDER/slam2d) among intel, fr079 and mit-csail, each as NAME.clf.gz with
/// NAME.relations.gz. Throws FileError where there is no such folder, or none of the logs in it. Nothing without a
/// folder.
std::vector<RealLog> real_logs(const std::string& folder);

}  // namespace gdtslam::reproduce
