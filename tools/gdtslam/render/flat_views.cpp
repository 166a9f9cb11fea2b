// The studio's views without OpenGL: maps, fields, paths, plots.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "engine/drawing/maps/map_pictures.hpp"
#include "engine/runs/evaluation/errors.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/ticks.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "loops_film.hpp"
#include "studio.hpp"

namespace gdtslam {
namespace {

// Plots are drawn small and scaled up, which keeps the ratio of words to lines of a printed page.
PictureSize plot_size(const std::optional<PictureSize>& wanted) {
  constexpr double kWidth_px = 960.0;
  const PictureSize size = wanted.value_or(kStillSize);
  const double share = std::min(1.0, kWidth_px / size.width);
  return {static_cast<std::uint32_t>(std::lround(share * size.width)),
          static_cast<std::uint32_t>(std::lround(share * size.height))};
}

// Sorted by time, because relations may be unsorted.
std::vector<TrajectoryError> read_errors(RenderSource& source, const RenderOptions& options) {
  if (!options.relations.empty()) {
    const std::vector<Relation> relations = read_relations(options.relations);
    std::vector<TrajectoryError> errors = errors_against(source.trajectory(), relations);
    std::stable_sort(errors.begin(), errors.end(), [](const auto& a, const auto& b) { return a.stamp_s < b.stamp_s; });
    if (!errors.empty()) return errors;
    throw InputError({options.relations, 0}, fmt::format("none of its {} relations has stamps of {}; do both belong to "
                                                         "the same log?",
                                                         relations.size(), source.input()));
  }
  return errors_against(source.trajectory(), given_trajectory(options.reference));
}

// Summary of errors in the format of `gdtslam evaluate`: "RMSE 0.0124 m, largest 0.0312 m, 2,884 of 2,884 poses".
std::string error_words(const std::vector<double>& errors) {
  std::vector<double> known;
  for (const double error : errors) {
    if (std::isfinite(error)) known.push_back(error);
  }
  const ErrorSummary summary = summarise(known);
  return fmt::format("RMSE {}, largest {}, {} of {}", rounded_text(summary.rmse, "m"), rounded_text(summary.max, "m"),
                     with_commas(known.size()), counted(errors.size(), "pose"));
}

}  // namespace

MapLook RenderStudio::map_look() const {
  MapLook look;
  if (!hidden_.caption) {
    look.title = title();
    look.subtitle = subtitle();
  }
  look.colour_map = read_cloud_look(options_).colour_map;
  look.with_path = look.with_keyframes = !hidden_.path;
  look.is_transparent = read_background(options_.background) == Background::kNone;
  return look;
}

Canvas RenderStudio::map(const Wanted& wanted) {
  const PathOverlay overlay = first().overlay();
  if (!options_.colour_map.empty() && (hidden_.path || overlay.trajectory.empty())) {
    throw UsageError("--colour-map: has no effect on a map without its path, which alone has colours from low to high");
  }
  return map_view(first().map(), overlay, map_look(), wanted);
}

Canvas RenderStudio::graph(const Wanted& wanted) {
  const OccupancyMap& map = first().map();
  const RenderSource::Graph graph = first().graph();
  MapLook look = map_look();
  if (!hidden_.caption) look.subtitle = graph.subtitle;
  const PictureSize size = wanted.value_or(size_for_content(map.geometry.width, map.geometry.height));
  return graph_picture(map, graph.overlay, look, size);
}

Canvas RenderStudio::before_and_after_loops(const Wanted& wanted) {
  return loops_before_and_after(first(), map_look(), wanted);
}

std::unique_ptr<Film> RenderStudio::loops(const PictureSize& size, std::size_t frames) {
  constexpr std::size_t kHeldShare = 5;  // divisor of the length of a short film
  const auto second = static_cast<std::size_t>(std::lround(frames_per_s()));
  const LoopsFilmLength length{frames,
                               std::clamp<std::size_t>(second, 1, std::max<std::size_t>(frames / kHeldShare, 1))};
  return loops_film(first(), map_look(), size, length);
}

Canvas RenderStudio::field(const Wanted& wanted, bool is_intensity) {
  const FieldPicture& field = first().field();
  MapLook look = map_look();
  look.is_intensity = is_intensity;
  const PictureSize size = wanted.value_or(size_for_content(field.geometry.width, field.geometry.height));
  return field_picture(field, first().overlay(), look, size);
}

Canvas RenderStudio::intensity(const Wanted& wanted) { return field(wanted, true); }

Canvas RenderStudio::distance(const Wanted& wanted) { return field(wanted, false); }

RenderStudio::Errors RenderStudio::errors() {
  Errors all{{title(), "Position error", "m", {}}, {}};
  const std::vector<std::string> names = distinct_names();
  std::vector<std::vector<TrajectoryError>> errors;
  double first_s = std::numeric_limits<double>::infinity();
  for (RenderSource& source : sources_) {
    errors.push_back(read_errors(source, options_));
    for (const TrajectoryError& error : errors.back()) first_s = std::min(first_s, error.stamp_s);
  }
  for (std::size_t k = 0; k < sources_.size(); ++k) {
    ErrorGroup group{names[k], {}};
    TimeSeries line{names[k], {}};
    for (const TrajectoryError& error : errors[k]) {
      group.values.push_back(error.position_m);
      line.points.emplace_back(error.stamp_s - first_s, group.values.back());
    }
    all.plot.groups.push_back(std::move(group));
    all.series.push_back(std::move(line));
  }
  if (sources_.size() > 1 && options_.title.empty()) all.plot.title = fmt::format("{} runs", sources_.size());
  return all;
}

Canvas RenderStudio::errors_box(const Wanted& wanted) { return box_plot(errors().plot, plot_size(wanted)); }

Canvas RenderStudio::errors_cdf(const Wanted& wanted) { return distribution_plot(errors().plot, plot_size(wanted)); }

Canvas RenderStudio::errors_time(const Wanted& wanted) {
  const Errors all = errors();
  return time_plot(all.plot.title, all.plot.quantity, all.plot.unit, all.series, plot_size(wanted));
}

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
    if (options_.title.empty() && !hidden_.caption) look.title = fmt::format("{} paths", sources_.size());
  }
  std::vector<const Trajectory*> all;
  all.reserve(paths.size() + 1);
  for (const NamedPath& path : paths) all.push_back(&path.trajectory);
  if (truth) all.push_back(&*truth);
  return trajectories_picture(paths, truth ? &*truth : nullptr, look, wanted.value_or(size_for_paths(all)));
}

Canvas RenderStudio::errors_path(const Wanted& wanted) {
  if (sources_.size() > 1) throw UsageError("--view errors --as path draws one input");
  const Trajectory truth = given_trajectory(options_.reference);
  const PathOverlay overlay = first().overlay();
  const AlignedPath aligned = aligned_path(overlay.trajectory, truth);
  std::vector<double> errors;
  for (const std::optional<TrajectoryError>& error : aligned.errors) {
    errors.push_back(error ? error->position_m : std::numeric_limits<double>::quiet_NaN());
  }
  MapLook look = map_look();
  if (!hidden_.caption) look.subtitle = error_words(errors);
  const OpenRange range = read_scale_range(options_.range, CloudColour::kHeight);
  const PathErrors path{.trajectory = aligned.trajectory,
                        .drives = overlay.drives,
                        .errors = errors,
                        .quantity = axis_title("Position error", "m"),
                        .least = range.least,
                        .most = range.most};
  return path_errors_picture(path, truth, look, wanted.value_or(size_for_paths({&aligned.trajectory, &truth})));
}

}  // namespace gdtslam
