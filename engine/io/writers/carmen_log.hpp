// The records of a log as lines of CARMEN (docs/formats.md). A scan without odometry gets the pose of the odometry
// record before it. One object belongs to one thread.
#pragma once

#include <cstdint>

#include "engine/io/logs/carmen_writer.hpp"
#include "engine/io/logs/gzip_file.hpp"
#include "log_writer.hpp"

namespace gdtslam {

class CarmenLog final : public LogWriter {
 public:
  /// `file` must outlive this.
  CarmenLog(AtomicFile& file, const LogWriteOptions& options);
  bool write(const LogRecord& record) override;
  void finish() override { sink_.finish(); }
  [[nodiscard]] std::uint64_t bytes() const override { return sink_.bytes(); }

 private:
  bool write_scan(ScanRecord record);
  bool write_parameter(const Parameter& parameter);

  TextSink sink_;
  CarmenWriter writer_;
  Pose2 T_odom_last_;
  double told_max_range_m_ = 0.0;  ///< by the last PARAM
};

}  // namespace gdtslam
