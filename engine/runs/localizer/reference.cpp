#include "reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "engine/core/quantile.hpp"
#include "engine/runs/inputs/given_files.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {

MergedScans::MergedScans(const RunReader& run, double within_s) : within_s_(within_s) {
  const RunSummary& summary = run.summary();
  if (summary.keyframes.empty()) {
    throw InputError({run.folder(), 0},
                     "its report.json does not tell which scans went into the map (keyframe_scans): it is of an older "
                     "version; map the log again: gdtslam map LOG -o " +
                         run.folder());
  }
  const Trajectory trajectory = run.trajectory();
  for (const std::size_t index : summary.keyframes) stamps_s_.push_back(trajectory[index].stamp_s);
  std::sort(stamps_s_.begin(), stamps_s_.end());  // stamps of a log may step back
}

bool MergedScans::are_near(double stamp_s) const {
  const auto after = std::lower_bound(stamps_s_.begin(), stamps_s_.end(), stamp_s - within_s_);
  return after != stamps_s_.end() && *after <= stamp_s + within_s_;
}

std::string near_text(const MergedScans& merged) {
  if (merged.within_s() <= 0.0) return "that went into the map";
  return fmt::format("within {:g} s of one that went into the map", merged.within_s());
}

LocalizeTruth::LocalizeTruth(const std::string& file)
    : file_(file),
      poses_(given_trajectory(file)),
      by_stamp_(poses_),
      repeated_(poses_, ReferenceOptions{}.tolerance_s) {}

std::size_t LocalizeTruth::count_repeated() const {
  return static_cast<std::size_t>(
      std::count_if(poses_.begin(), poses_.end(), [&](const auto& pose) { return repeated_.have(pose.stamp_s); }));
}

void LocalizeTruth::align(const RunReader& run) {
  const ReferenceOptions options;
  const Pose2 T_map_reference = inverse(evaluate_reference(run.trajectory(), poses_, options).T_reference_estimate);
  for (StampedPose& pose : poses_) pose.T_map_base = T_map_reference * pose.T_map_base;
  by_stamp_ = PosesByStamp(poses_);
  is_aligned_ = true;
}

std::optional<Pose2> LocalizeTruth::find(double stamp_s) const {
  if (repeated_.have(stamp_s)) return std::nullopt;
  return by_stamp_.find(stamp_s, ReferenceOptions{}.tolerance_s);
}

std::optional<std::string> run_folder_of(const std::string& map) {
  namespace fs = std::filesystem;
  if (RunReader::is_run(map)) return map;
  const std::string parent = fs::path(map).has_parent_path() ? fs::path(map).parent_path().string() : ".";
  return RunReader::is_run(parent) ? std::optional(parent) : std::nullopt;
}

RunReader run_of_map(const std::string& map, const std::string& purpose) {
  if (const std::optional<std::string> folder = run_folder_of(map)) return RunReader(*folder);
  throw InputError({map, 0},
                   "belongs to no folder of a run, which " + purpose + " needs: give what 'gdtslam map -o' wrote");
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
