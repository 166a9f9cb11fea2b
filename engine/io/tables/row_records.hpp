// Rows of tables to records. What is said of the sensor (bearings, limit, mount, times of the beams) holds for the rows
// behind it too, until another says otherwise. One object belongs to one thread; linear in the beams.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/io/scan_sequence.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"
#include "table_row.hpp"

namespace gdtslam {

/// The bearings of a scan that was a cloud of points: beams every 0.05 degrees, each with the nearest point within half
/// a step; a point moves sideways by at most 0.44 mm for each metre of its range, and never along its beam.
inline constexpr int kPointBeams = 7200;

class RowRecords {
 public:
  explicit RowRecords(const ReadOptions& options) : options_(options) {}
  /// The records of the row, one for each kind of thing that it says: the crank's before the scan or the odometry.
  /// Throws MalformedRow.
  std::vector<LogRecord> records(TableRow& row, RangeRepairs& repairs);

 private:
  ScanRecord make_scan(TableRow& row, RangeRepairs& repairs);
  void set_bearings(LaserScan& scan) const;
  [[nodiscard]] Pose2 mount() const;

  ReadOptions options_;
  TableRow said_;  ///< last of the sensor
};

}  // namespace gdtslam
