// What is true of a simulated log of a nodding laser, in files beside it: the elevation of each scan, every hit. One
// object belongs to one thread.
#pragma once

#include <cstdint>
#include <string>

#include "engine/core/memory/scratch_file.hpp"
#include "engine/io/atomic_file.hpp"
#include "gdtslam/sim/simulation.hpp"

namespace gdtslam {

/// A row per scan: scan,stamp_s,crank_turns,elevation_rad.
class ElevationRows {
 public:
  explicit ElevationRows(AtomicFile& file);
  void add(const sim::SimulatedScan& scan);

 private:
  AtomicFile& file_;
  std::uint64_t scans_ = 0;
};

/// Binary PLY with a row for every beam whose measured range is a return, in the order of the log: double x y z (the
/// true hit), elevation (of the scan plane when the beam was fired), time, range (true); uint scan, beam, triangle (of
/// the scene's mesh). Rows wait in an unnamed temporary file, because the header tells their number.
class HitCloud {
 public:
  /// Throws FileError, as all members do.
  explicit HitCloud(AtomicFile& file) : file_(file) {}
  void add(const sim::SimulatedScan& scan, double max_range_m);
  /// Writes header and rows; the last call.
  void finish();

 private:
  AtomicFile& file_;
  ScratchFile rows_{""};
  std::uint64_t bytes_ = 0;  // of rows_
  std::string row_;
  std::uint64_t scans_ = 0;
  std::uint64_t hits_ = 0;
};

}  // namespace gdtslam
