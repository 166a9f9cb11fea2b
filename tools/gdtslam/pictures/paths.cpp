// The studio's views of paths without a map: alone, over the truth, in the colours of their errors.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "engine/drawing/maps/path_pictures.hpp"
#include "engine/drawing/plots/plot_sheet.hpp"
#include "engine/runs/evaluation/errors.hpp"
#include "engine/runs/inputs/given_files.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "studio.hpp"

namespace gdtslam {
namespace {

// What evaluate says of these errors: "RMSE 0.0124 m, largest 0.0312 m, 2,884 of 2,884 poses".
std::string error_words(const std::vector<double>& errors, const std::string& unit) {
  std::vector<double> known;
  for (const double error : errors) {
    if (std::isfinite(error)) known.push_back(error);
  }
  const ErrorSummary summary = summarise(known);
  return fmt::format("RMSE {}, largest {}, {} of {}", picture::value_text(summary.rmse, unit),
                     picture::value_text(summary.max, unit), with_commas(known.size()), counted(errors.size(), "pose"));
}

}  // namespace

std::vector<std::string> RenderStudio::distinct_names() const {
  std::vector<std::string> names;
  const auto are_distinct = [&names] { return std::set(names.begin(), names.end()).size() == names.size(); };
  for (const RenderSource& source : sources_) names.push_back(source.name());
  if (are_distinct()) return names;
  names.clear();
  for (const RenderSource& source : sources_) names.push_back(name_of_place(source.input()));
  if (are_distinct()) return names;
  names.clear();
  for (const RenderSource& source : sources_) names.push_back(source.input());
  return names;
}

Canvas RenderStudio::trajectory(const Wanted& wanted) {
  MapLook look = map_look();
  if (sources_.size() == 1 && options_.reference.empty()) {
    const PathOverlay path = first().overlay();
    return trajectory_picture(path, look, wanted.value_or(size_for_paths({&path.trajectory})));
  }
  if (!options_.colour_map.empty()) {
    throw UsageError("--colour-map: has no effect on paths over the truth or side by side, which have a colour each");
  }
  std::optional<Trajectory> truth;
  if (!options_.reference.empty()) truth = given_trajectory(options_.reference);
  std::vector<NamedPath> paths;
  const std::vector<std::string> names = distinct_names();
  for (std::size_t k = 0; k < sources_.size(); ++k) {
    PathOverlay overlay = sources_[k].overlay();
    if (truth) overlay.trajectory = aligned_path(overlay.trajectory, *truth).trajectory;
    paths.push_back({names[k], std::move(overlay.trajectory), std::move(overlay.drives)});
  }
  if (sources_.size() > 1) {
    look.subtitle.clear();
    if (options_.title.empty() && !options_.no_caption) look.title = fmt::format("{} paths", sources_.size());
  }
  std::vector<const Trajectory*> all;
  all.reserve(paths.size() + 1);
  for (const NamedPath& path : paths) all.push_back(&path.trajectory);
  if (truth) all.push_back(&*truth);
  return trajectories_picture(paths, truth ? &*truth : nullptr, look, wanted.value_or(size_for_paths(all)));
}

Canvas RenderStudio::errors_path(const Wanted& wanted) {
  const bool is_angle = options_.is_angle;
  const std::string unit = is_angle ? "°" : "m";
  const Trajectory truth = given_trajectory(options_.reference);
  const PathOverlay overlay = first().overlay();
  const AlignedPath aligned = aligned_path(overlay.trajectory, truth);
  std::vector<double> errors;
  for (const std::optional<TrajectoryError>& error : aligned.errors) {
    errors.push_back(!error     ? std::numeric_limits<double>::quiet_NaN()
                     : is_angle ? error->angle_deg
                                : error->position_m);
  }
  MapLook look = map_look();
  if (!options_.no_caption) look.subtitle = error_words(errors, unit);
  const ScaleRange range = scale_range_of(options_.range, is_angle ? CloudColour::kElevation : CloudColour::kHeight);
  const auto in_unit = [is_angle](const std::optional<double>& value) {
    return value && is_angle ? std::optional<double>(deg_from_rad(*value)) : value;
  };
  const PathErrors path{.trajectory = aligned.trajectory,
                        .drives = overlay.drives,
                        .errors = errors,
                        .quantity = picture::axis_title(is_angle ? "Heading error" : "Position error", unit),
                        .least = in_unit(range.least),
                        .most = in_unit(range.most)};
  return path_errors_picture(path, truth, look, wanted.value_or(size_for_paths({&aligned.trajectory, &truth})));
}

}  // namespace gdtslam
