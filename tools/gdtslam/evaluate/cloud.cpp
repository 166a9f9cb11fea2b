// Distances of a cloud from the truth: a scene, or the true hits of its beams.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/evaluation/hit_errors.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "evaluate.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/folders.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"
#ifdef GDTSLAM_HAS_SIM
#include "tools/gdtslam/scenes/scene_errors.hpp"
#endif

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

void check_cloud_usage(const EvaluateOptions& options) {
  const bool has_trajectory = !options.trajectory.empty() || RunReader::is_run(options.file);
  if (!options.trajectory.empty() && options.reference.empty()) {
    throw UsageError("a cloud is aligned by two trajectories: give both --trajectory and --reference, or neither");
  }
  if (!options.reference.empty() && !has_trajectory) {
    throw UsageError(
        "a cloud is aligned by two trajectories: give both --trajectory and --reference, or neither; a run's folder in "
        "place of its cloud has the trajectory");
  }
  if (options.linkage.empty() != options.resolution.empty()) {
    throw UsageError("the quantisation bound needs both --linkage and --resolution");
  }
  if (!options.linkage.empty() && options.hits.empty()) throw UsageError("--linkage belongs to --hits");
}

// Throws if the run is replaced meanwhile, so cloud and trajectory come from one run.
template <class Compute>
auto unless_changed(const std::optional<RunReader>& run, const Compute& compute) {
  return run ? run->files().unless_changed(compute) : compute();
}

double parse_resolution(const std::string& text) {
  const double length_m = quantity_of("--resolution", text, Unit::kMetre);
  if (length_m < 0.0) throw UsageError("--resolution: '" + text + "' is below zero");
  return length_m;
}

int finish(const EvaluateOptions& options, const DistanceHistogram& distances, const std::string& text,
           const Json& json, bool was_interrupted) {
  if (was_interrupted) return static_cast<int>(ExitCode::kInterrupted);
  if (!options.csv.empty()) write_file_atomically(options.csv, distances.csv());
  print_result(options.json ? json_text(json) : text);
  return static_cast<int>(ExitCode::kDone);
}

#ifdef GDTSLAM_HAS_SIM
int against_scene(const EvaluateOptions& options) {
  ProgressLine line("points", options.json);
  std::optional<RunReader> run;
  SceneErrorsJob job{.cloud = given_cloud(options.file, run),
                     .scene = options.scene,
                     .scene_folders = asset_folders("scenes"),
                     .frame = align_cloud(options)};
  job.progress = [&line](std::uint64_t count, double share) { line.update(count, share); };
  job.stop = [] { return interrupted(); };
  const SceneErrors errors = unless_changed(run, [&job] { return scene_errors(job); });
  line.clear();
  if (errors.distances.count() == 0 && !errors.interrupted) {
    throw InputError({job.cloud, 0}, "holds no point with finite coordinates");
  }
  std::string text = errors.distances.text() + frame_text(job.frame, "cloud and truth", options.no_align);
  if (errors.skipped > 0) text += plural(errors.skipped, "point") + " with values that are not finite left out\n";
  const Json json{{"metric", "scene"},
                  {"scene", errors.scene_file},
                  {"triangles", errors.triangles},
                  {"distance_m", errors.distances.json()},
                  {"skipped", errors.skipped},
                  {"alignment", frame_json(job.frame)}};
  return finish(options, errors.distances, text, json, errors.interrupted);
}
#else
int against_scene(const EvaluateOptions& /*options*/) {
  throw UnavailableError("this build cannot read scenes; configure it with -DGDTSLAM_BUILD_SIM=ON");
}
#endif

Json bound_json(const std::optional<BoundCheck>& bound) {
  if (!bound) return nullptr;
  return {{"beyond", bound->beyond}, {"largest_share", bound->largest_share}, {"largest_m", bound->largest_bound_m}};
}

int against_hits(const EvaluateOptions& options) {
  ProgressLine line("points", options.json);
  std::optional<RunReader> run;
  HitErrorsJob job{.cloud = given_cloud(options.file, run), .hits = options.hits, .frame = align_cloud(options)};
  if (!options.linkage.empty()) {
    job.quantisation = {resolve_linkage(options.linkage), parse_resolution(options.resolution)};
  }
  job.progress = [&line](std::uint64_t count, double share) { line.update(count, share); };
  job.stop = [] { return interrupted(); };
  const HitErrors errors = unless_changed(run, [&job] { return hit_errors(job); });
  line.clear();
  std::string text = errors.distances.text();
  text += fmt::format("each to the true hit of its beam, of which there are {}; {} points without one\n", errors.hits,
                      errors.without_hit);
  if (errors.bound) {
    text += fmt::format("quantisation bound, at most {:.6f} m: {} points beyond it, the worst at {:.1f} % of its own\n",
                        errors.bound->largest_bound_m, errors.bound->beyond, 100.0 * errors.bound->largest_share);
  }
  text += frame_text(job.frame, "cloud and truth", options.no_align);
  const Json json{{"metric", "hits"},
                  {"distance_m", errors.distances.json()},
                  {"hits", errors.hits},
                  {"without_hit", errors.without_hit},
                  {"quantisation_bound", bound_json(errors.bound)},
                  {"alignment", frame_json(job.frame)}};
  return finish(options, errors.distances, text, json, errors.interrupted);
}
}  // namespace

CloudFrame align_cloud(const EvaluateOptions& options) {
  CloudFrame frame;
  if (options.reference.empty()) return frame;
  const std::string& path = options.trajectory.empty() ? options.file : options.trajectory;
  frame.trajectory =
      evaluate_reference(given_trajectory(path), given_trajectory(options.reference), reference_options(options));
  frame.T_truth_map = frame.trajectory->T_reference_estimate;
  return frame;
}

Json frame_json(const CloudFrame& frame) {
  if (!frame.trajectory) return nullptr;
  const Pose2& T = frame.T_truth_map;
  return {{"x_m", T.x_m},
          {"y_m", T.y_m},
          {"theta_rad", T.theta_rad},
          {"ate_mean_m", frame.trajectory->ate_m.mean},
          {"ate_max_m", frame.trajectory->ate_m.max}};
}

std::string frame_text(const CloudFrame& frame, const std::string& what, bool no_align) {
  if (!frame.trajectory) return "the frames of " + what + " taken as the same\n";
  const Pose2& T = frame.T_truth_map;
  return fmt::format("{}: {:.4f} m, {:.4f} m, {:.4f} deg; ATE of the trajectory {:.4f} m\n",
                     no_align ? "first poses made to agree" : "rigid alignment of the trajectory", T.x_m, T.y_m,
                     deg_from_rad(T.theta_rad), frame.trajectory->ate_m.mean);
}

int evaluate_cloud(const EvaluateOptions& options) {
  check_cloud_usage(options);
  WrittenFiles({options.file, options.reference, options.hits, options.trajectory, linkage_file_of(options.linkage),
                options.scene},
               options.force)
      .add("--csv", options.csv);
  return options.scene.empty() ? against_hits(options) : against_scene(options);
}

}  // namespace gdtslam
