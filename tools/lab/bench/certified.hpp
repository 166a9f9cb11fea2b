// What `gdtslam bench certified` measures: a log is mapped, and scans of it are looked for again in its merged map, in
// windows of growing size whose centres are off the pose that mapping found, by the matcher `certified` and by a plain
// lattice of poses. Frame: map. One thread; the poses depend on the log and the configuration alone, the times on the
// machine.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {

struct CertifiedBenchJob {
  std::string log;
  MapperConfig mapper;
  std::uint64_t scans = 100;  ///< that are looked for, evenly over the log
  double gap_m = 0.005;
  double lattice_s = 5.0;  ///< CPU time that the peer may take for a window, of one scan at least; 0: no peer
};

/// One size of window.
struct CertifiedBenchRow {
  double half_m = 0.0;
  double half_rad = 0.0;  ///< pi: every heading
  double median_s = 0.0;  ///< CPU time of a search, from the points to the proof, nothing known before
  double p90_s = 0.0;
  double most_s = 0.0;
  double median_boxes = 0.0;
  std::uint64_t most_boxes = 0;
  std::uint64_t median_evaluations = 0;
  double proven_share = 0.0;  ///< whose gap was reached
  double known_share = 0.0;   ///< that ended within 10 cm and 1 degree of the pose that mapping found
  // The peer: every pose of a lattice, then a descent from the best.
  std::uint64_t lattice_scans = 0;
  std::uint64_t lattice_poses = 0;  ///< of one window
  double lattice_median_s = 0.0;
  double lattice_best_share = 0.0;  ///< that ended within the gap of the least cost
  [[nodiscard]] double times_lattice() const { return lattice_median_s / median_s; }
};

struct CertifiedBench {
  std::uint64_t log_scans = 0;
  std::uint64_t scans = 0;  ///< that were looked for
  double median_points = 0.0;
  std::uint32_t map_width = 0;
  std::uint32_t map_height = 0;
  std::uint64_t map_bytes = 0;  ///< of the field
  double prepare_s = 0.0;       ///< CPU time, for windows of any size
  std::uint64_t prepared_bytes = 0;
  std::vector<CertifiedBenchRow> rows;
};

/// The lattice's spacing.
inline constexpr double kLatticeStep_m = 0.05;
inline constexpr double kLatticeStep_rad = 0.017453292519943295;

/// The backend is the CPU's. Throws InputError, FileError; Error(kInterrupted) when stop() became true.
CertifiedBench bench_certified(const CertifiedBenchJob& job, Backend& backend, const std::function<bool()>& stop);

/// As the command prints it.
std::string as_text(const CertifiedBenchJob& job, const CertifiedBench& bench, const Backend& backend);
std::string json_text_of(const CertifiedBenchJob& job, const CertifiedBench& bench, const Backend& backend);

}  // namespace gdtslam
