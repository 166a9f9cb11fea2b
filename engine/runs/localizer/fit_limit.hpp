// How well a scan of the mapped place fits, and the run that a map belongs to. Thread-safe; O(n log n).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gdtslam {

/// The run folder that a map belongs to: itself, or the folder of its gdt.yaml; none where that is none.
std::optional<std::string> run_folder_of(const std::string& map);

/// How well a scan of the mapped place fits: mean distances of its points to the map's obstacles.
struct FitLimit {
  /// The largest comes from an option, from 99 of 100 of the run's own scans, or from the size of the map's cells.
  enum class Source : std::uint8_t { kOption, kRun, kResolution };
  double distance_m = 0.0;  ///< the largest that is a good fit
  Source source = Source::kOption;
  double usual_m = 0.0;  ///< the median
};
/// From the mean distances that the run's own scans leave in the finished map. Two cells are always a good fit: the
/// most that rounding to cells in the scan and in the map can account for, while scans that a map was made of fit it
/// better than others. Without scans one cell is usual.
FitLimit fit_limit_of(std::vector<double> own_m, double resolution_m);

}  // namespace gdtslam
