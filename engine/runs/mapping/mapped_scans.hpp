// What is kept of each scan until a drive has ended: its pose, and of a match that was taken the distance of its points
// to the map. On shelves, so that memory does not grow with the hours.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/core/memory/byte_shelf.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

class MappedScans {
 public:
  /// The files are made in that folder (ByteShelf).
  explicit MappedScans(const std::string& folder)
      : poses_(folder, ByteShelf::kFewBytes), distances_m_(folder, ByteShelf::kFewBytes) {}

  void add(const StampedPose& pose) { poses_.put(pose); }
  void add_distance(double distance_m) { distances_m_.put(distance_m); }
  /// Those that have a pose.
  [[nodiscard]] std::size_t size() const { return poses_.size(); }

  /// In the order in which they came. Both throw FileError.
  [[nodiscard]] Trajectory trajectory() const { return poses_.all(); }
  [[nodiscard]] std::vector<double> distances_m() const { return distances_m_.all(); }

 private:
  Shelf<StampedPose> poses_;
  Shelf<double> distances_m_;
};

}  // namespace gdtslam
