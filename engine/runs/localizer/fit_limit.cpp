#include "fit_limit.hpp"

#include <algorithm>
#include <filesystem>

#include "engine/core/quantile.hpp"
#include "engine/runs/folder/run_reader.hpp"

namespace gdtslam {

std::optional<std::string> run_folder_of(const std::string& map) {
  namespace fs = std::filesystem;
  if (RunReader::is_run(map)) return map;
  const std::string parent = fs::path(map).has_parent_path() ? fs::path(map).parent_path().string() : ".";
  return RunReader::is_run(parent) ? std::optional(parent) : std::nullopt;
}

FitLimit fit_limit_of(std::vector<double> own_m, double resolution_m) {
  const FitLimit of_cells{2.0 * resolution_m, FitLimit::Source::kResolution, resolution_m};
  if (own_m.empty()) return of_cells;
  std::sort(own_m.begin(), own_m.end());
  const double usual_m = quantile_of_sorted(own_m, 0.5);
  const double most_m = quantile_of_sorted(own_m, 0.99);
  if (most_m < of_cells.distance_m) return {of_cells.distance_m, of_cells.source, usual_m};
  return {most_m, FitLimit::Source::kRun, usual_m};
}

}  // namespace gdtslam
