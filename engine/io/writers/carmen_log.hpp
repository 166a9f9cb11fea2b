// The records of a log as lines of CARMEN (docs/formats.md). A scan without odometry gets the pose of the odometry
// record before it. One object belongs to one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

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
  /// Where its line does not say it; false where the scan would get another limit than it has.
  bool tell_limit(const ScanRecord& record, const std::string& at);

  TextSink sink_;
  CarmenWriter writer_;
  Pose2 T_odom_last_;
  double told_max_range_m_ = 0.0;            ///< by the last PARAM; 0 where it is to be told again
  std::optional<std::size_t> told_laser_{};  ///< of that PARAM, which readers know from then on
  std::array<bool, 2> has_no_limit_{};       ///< the last scan of each laser
};

}  // namespace gdtslam
