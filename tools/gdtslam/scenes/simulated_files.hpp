// Files that a simulation writes: the log in the format of its name, and the truth of a nodding laser (the elevation of
// each scan, every hit). One object belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/memory/scratch_file.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/logs/gzip_file.hpp"
#include "engine/io/logs/steady_mount.hpp"
#include "engine/io/writers/log_writer.hpp"
#include "gdtslam/sim/simulation.hpp"

namespace gdtslam {

/// Properties of scans that CARMEN lines cannot carry.
struct UnsaidOfScans {
  double max_range_m = 0.0;
  double beam_period_s = 0.0;  ///< the stamp is the first beam's; 0: all beams have the stamp
};

/// The simulated log in the format of its name, by default CARMEN. Other formats are converted from the CARMEN lines,
/// so all have the same numbers.
class SimulatedLog {
 public:
  /// Throws UsageError; all members throw FileError.
  SimulatedLog(const std::string& path, const UnsaidOfScans& unsaid, AtomicFileSet& files);
  /// Writes whole CARMEN lines.
  void write(std::string_view lines);
  void finish();
  /// Size before compression.
  [[nodiscard]] std::uint64_t bytes() const { return text_ ? text_->bytes() : records_->bytes(); }
  /// Data that the format cannot carry.
  [[nodiscard]] std::vector<LogReader::Warning> left_out() const;

 private:
  std::unique_ptr<TextSink> text_;      ///< CARMEN
  std::unique_ptr<LogWriter> records_;  ///< the others
  SteadyMount mount_;
  UnsaidOfScans unsaid_;
  std::uint64_t untimed_scans_ = 0;  ///< scans with beam times, which CARMEN cannot carry
};

/// A row per scan: scan,stamp_s,crank_turns,elevation_rad.
class ElevationRows {
 public:
  explicit ElevationRows(AtomicFile& file);
  void add(const sim::SimulatedScan& scan);

 private:
  AtomicFile& file_;
  std::uint64_t scans_ = 0;
};

/// Binary PLY with a row for every beam whose measured range is a return, in the log's order: double x y z (the true
/// hit), elevation (of the scan plane when the beam was fired), time, range (true); uint scan, beam, triangle (of the
/// scene's mesh). Rows wait in an unnamed temporary file, because the header contains their number.
class HitCloud {
 public:
  /// Throws FileError, like all members.
  explicit HitCloud(AtomicFile& file) : file_(file) {}
  void add(const sim::SimulatedScan& scan, double max_range_m);
  /// Writes header and rows; call it last.
  void finish();

 private:
  AtomicFile& file_;
  ScratchFile rows_{""};
  std::uint64_t bytes_ = 0;  // size of rows_
  std::string row_;
  std::uint64_t scans_ = 0;
  std::uint64_t hits_ = 0;
};

}  // namespace gdtslam
