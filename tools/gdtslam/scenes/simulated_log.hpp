// The log of a simulation in the format of its name, CARMEN where that is no other. Every format has the numbers of the
// CARMEN log: its lines are read again for the others. One object belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/logs/gzip_file.hpp"
#include "engine/io/logs/steady_mount.hpp"
#include "engine/io/writers/log_writer.hpp"

namespace gdtslam {

/// What CARMEN's lines do not say of a scan.
struct UnsaidOfScans {
  double max_range_m = 0.0;
  double beam_period_s = 0.0;  ///< the first beam being that of the stamp; 0: all are
};

class SimulatedLog {
 public:
  /// Throws UsageError, FileError, as all members do the latter.
  SimulatedLog(const std::string& path, const UnsaidOfScans& unsaid, AtomicFileSet& files);
  /// Whole lines of CARMEN.
  void write(std::string_view lines);
  void finish();
  /// Before a .gz around them.
  [[nodiscard]] std::uint64_t bytes() const { return text_ ? text_->bytes() : records_->bytes(); }
  /// What the format cannot carry.
  [[nodiscard]] std::vector<LogReader::Warning> left_out() const;

 private:
  std::unique_ptr<TextSink> text_;      ///< CARMEN
  std::unique_ptr<LogWriter> records_;  ///< the others
  SteadyMount mount_;
  UnsaidOfScans unsaid_;
  std::uint64_t untimed_scans_ = 0;  ///< whose beam times CARMEN could not say
};

}  // namespace gdtslam
