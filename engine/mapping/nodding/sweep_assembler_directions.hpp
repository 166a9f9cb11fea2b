// Where the beams of a scan point in the nodding frame: one row of unit vectors for each way in which scans lay out
// their bearings, kept as long as scans use it. Not thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gdtslam/core/nodding.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

class BeamDirections {
 public:
  explicit BeamDirections(const NoddingMount& mount) : mount_(mount) {}

  /// The row of a scan's first beam, if it is there or there is room for it.
  std::optional<std::uint32_t> row_of(const LaserScan& scan);
  /// Forgets all rows.
  void clear();

  /// x, y, z, as the kernel takes them.
  [[nodiscard]] const std::vector<std::array<float, 3>>& rows() const { return rows_; }
  /// A scan whose beams are more than that is alone in the table.
  static constexpr std::size_t kMostRows = std::size_t{1} << 18U;

 private:
  struct Layout {
    double first_bearing_rad;
    double bearing_step_rad;
    std::size_t beams;
    std::uint32_t row;
  };
  void append(double bearing_rad);

  NoddingMount mount_;
  std::vector<Layout> layouts_;
  std::vector<std::array<float, 3>> rows_;
};

}  // namespace gdtslam
