// Converts rows of tables to records. Values of the sensor (bearings, limit, mount, times of the beams) also apply to
// later rows until one states others. One object belongs to one thread; linear in the beams.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/io/scan_sequence.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"
#include "table_row.hpp"

namespace gdtslam {

/// Beams of a scan from a cloud of points: one every 0.05 degrees, with the nearest point within half a step. A point
/// moves sideways by at most 0.44 mm for each metre of its range, and never along its beam.
inline constexpr int kPointBeams = 7200;

class RowRecords {
 public:
  explicit RowRecords(const ReadOptions& options) : options_(options) {}
  /// The records of the row, one for each kind: the crank's before the scan or the odometry. Throws MalformedRow.
  std::vector<LogRecord> records(TableRow& row, RangeRepairs& repairs);

 private:
  ScanRecord make_scan(TableRow& row, RangeRepairs& repairs);
  void set_bearings(LaserScan& scan) const;
  [[nodiscard]] Pose2 mount() const;

  ReadOptions options_;
  TableRow said_;  ///< the last values of the sensor
};

}  // namespace gdtslam
