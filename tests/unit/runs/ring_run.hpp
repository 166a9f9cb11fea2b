// A drive past rooms around a block whose walls and poses are known, as a log and as the run that mapping it gives: for
// tests of what is done with runs. It is mapped once for all tests of a process.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gdtslam/runs/map_log.hpp"
#include "support/room.hpp"

namespace gdtslam::test {

/// A folder of this process, gone with the object.
class RunsFolder {
 public:
  explicit RunsFolder(const std::string& name);
  RunsFolder(const RunsFolder&) = delete;
  RunsFolder& operator=(const RunsFolder&) = delete;
  ~RunsFolder();
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
};

/// A scan each 0.5 s from 1000 s on, with wheels that are off by some millimetres and milliradians a step.
void write_ring_log(const std::string& file, const std::vector<Pose2>& truth, std::uint64_t seed);

/// Likewise through a place as it is at a time.
struct DrivenPlace {
  std::vector<Segment> walls;
  double begins_at_s = 0.0;
};
void write_drive_log(const std::string& file, const DrivenPlace& place, const std::vector<Pose2>& truth,
                     std::uint64_t seed);

/// Once around and 10 m on.
std::vector<Pose2> ring_drive();

/// Where a pose of the drive is in the run's map, whose frame is that of the first scan.
inline Pose2 in_ring_map(const Pose2& truth) { return between(ring_drive().front(), truth); }

struct RingRun {
  std::string log;
  std::string folder;
  std::vector<Pose2> truth;  ///< in the run's map
  MapResult result;
};
const RingRun& ring_run();

/// Maps a log with the defaults, without pictures.
MapRequest ring_request(const std::string& log, const std::string& folder);

std::string text_of_file(const std::string& file);

}  // namespace gdtslam::test
