// gdtslam evaluate: how far a trajectory is from what somebody verified, or a cloud from the truth.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/evaluation/hit_errors.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/folders.hpp"
#include "tools/gdtslam/shell/options.hpp"
#ifdef GDTSLAM_HAS_SIM
#include "tools/gdtslam/scenes/scene_errors.hpp"
#endif

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

struct EvaluateOptions {
  std::string file;  ///< a trajectory, or with scene or hits a cloud
  std::string relations;
  std::string reference;      ///< of a cloud: with `trajectory`, else both frames are the same
  double tolerance_s = -1.0;  ///< negative: the default
  double distance_m = ReferenceOptions{}.rpe_distance_m;
  bool no_align = false;
  bool json = false;
  // Of a cloud.
  std::string scene;       ///< one of these two
  std::string hits;        ///< likewise
  std::string trajectory;  ///< of the run that made the cloud
  std::string linkage;     ///< with hits: for the quantisation bound
  std::string resolution;  ///< of the ranges, a length; with linkage
  std::string csv;
};

constexpr double kMost_s = 1e9;
constexpr double kLeastDistance_m = 1e-3;
constexpr double kMostDistance_m = 1e9;

constexpr const char* kHeading = "                    count      mean       std    median      rmse       max\n";

// Without a sample there is no error to state; a zero would look like a perfect one.
std::string row(const std::string& name, const ErrorSummary& e, const std::string& unit) {
  if (e.count == 0) {
    return fmt::format("{:<16} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9}  {}\n", name, 0, "-", "-", "-", "-", "-", unit);
  }
  return fmt::format("{:<16} {:>8} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f}  {}\n", name, e.count, e.mean,
                     e.deviation, e.median, e.rmse, e.max, unit);
}

Json as_json(const ErrorSummary& e) {
  const auto value = [&e](double number) { return e.count > 0 ? Json(number) : Json(); };
  return {{"count", e.count},          {"mean", value(e.mean)}, {"std", value(e.deviation)},
          {"median", value(e.median)}, {"rmse", value(e.rmse)}, {"max", value(e.max)}};
}

Json as_json(const RelationErrors& e) {
  return {{"translation_m", as_json(e.translation_m)}, {"rotation_deg", as_json(e.rotation_deg)}};
}

std::string relation_text(const RelationReport& report) {
  std::string text = kHeading;
  text += row("all", report.all.translation_m, "m") + row("", report.all.rotation_deg, "deg");
  text += row("short (<= 20 s)", report.short_term.translation_m, "m") + row("", report.short_term.rotation_deg, "deg");
  text += row("loops (> 20 s)", report.loops.translation_m, "m") + row("", report.loops.rotation_deg, "deg");
  text += fmt::format("worst relation: {:.6f} to {:.6f}\n", report.worst_t1_s, report.worst_t2_s);
  if (report.unmatched > 0) {
    text += fmt::format("{} relations have stamps that the trajectory does not have\n", report.unmatched);
  }
  return text;
}

Json relation_json(const RelationReport& report) {
  return {{"metric", "relations"},
          {"all", as_json(report.all)},
          {"short", as_json(report.short_term)},
          {"loops", as_json(report.loops)},
          {"unmatched", report.unmatched},
          {"worst", {{"t1_s", report.worst_t1_s}, {"t2_s", report.worst_t2_s}}}};
}

int evaluate_against_relations(const EvaluateOptions& options) {
  const Trajectory trajectory = read_tum(options.file);
  const std::vector<Relation> relations = read_relations(options.relations);
  const RelationReport report = options.tolerance_s < 0.0
                                    ? evaluate_relations(trajectory, relations)
                                    : evaluate_relations(trajectory, relations, options.tolerance_s);
  if (report.all.translation_m.count == 0) {
    throw InputError({options.relations, 0},
                     fmt::format("none of its {} relations has stamps of {}; do both belong to the same log?",
                                 relations.size(), options.file));
  }
  print_result(options.json ? json_text(relation_json(report)) : relation_text(report));
  return static_cast<int>(ExitCode::kDone);
}

std::string reference_text(const ReferenceReport& report, const ReferenceOptions& options) {
  std::string text = kHeading;
  text += row("ATE", report.ate_m, "m") + row("", report.ate_rotation_deg, "deg");
  text += row(fmt::format("RPE per {:g} m", options.rpe_distance_m), report.rpe_m, "m");
  text += row("", report.rpe_rotation_deg, "deg");
  text += fmt::format("{}: {:.4f} m, {:.4f} m, {:.4f} deg\n",
                      options.align ? "rigid alignment (least squares)" : "first poses made to agree",
                      report.T_reference_estimate.x_m, report.T_reference_estimate.y_m,
                      deg_from_rad(report.T_reference_estimate.theta_rad));
  if (report.rpe_m.count == 0) {
    text += fmt::format("no RPE: no two poses are {:g} m of reference path apart\n", options.rpe_distance_m);
  }
  if (report.unmatched > 0) text += fmt::format("{} poses have no counterpart in the reference\n", report.unmatched);
  return text;
}

Json reference_json(const ReferenceReport& report, const ReferenceOptions& options) {
  const Pose2& T = report.T_reference_estimate;
  return {{"metric", "reference"},
          {"ate", {{"translation_m", as_json(report.ate_m)}, {"rotation_deg", as_json(report.ate_rotation_deg)}}},
          {"rpe",
           {{"distance_m", options.rpe_distance_m},
            {"translation_m", as_json(report.rpe_m)},
            {"rotation_deg", as_json(report.rpe_rotation_deg)}}},
          {"aligned", options.align},
          {"T_reference_estimate", {{"x_m", T.x_m}, {"y_m", T.y_m}, {"theta_rad", T.theta_rad}}},
          {"matched", report.matched},
          {"unmatched", report.unmatched}};
}

ReferenceOptions reference_options(const EvaluateOptions& options) {
  ReferenceOptions reference{.rpe_distance_m = options.distance_m, .align = !options.no_align};
  if (options.tolerance_s >= 0.0) reference.tolerance_s = options.tolerance_s;
  return reference;
}

int evaluate_against_reference(const EvaluateOptions& options) {
  const ReferenceOptions reference = reference_options(options);
  const ReferenceReport report = evaluate_reference(read_tum(options.file), read_tum(options.reference), reference);
  print_result(options.json ? json_text(reference_json(report, reference)) : reference_text(report, reference));
  return static_cast<int>(ExitCode::kDone);
}

void check_cloud_usage(const EvaluateOptions& options) {
  if (options.trajectory.empty() != options.reference.empty()) {
    throw UsageError("a cloud is aligned by two trajectories: give both --trajectory and --reference, or neither");
  }
  if (options.linkage.empty() != options.resolution.empty()) {
    throw UsageError("the quantisation bound needs both --linkage and --resolution");
  }
  if (!options.linkage.empty() && options.hits.empty()) throw UsageError("--linkage belongs to --hits");
}

CloudFrame frame_of(const EvaluateOptions& options) {
  CloudFrame frame;
  if (options.trajectory.empty()) return frame;
  frame.trajectory =
      evaluate_reference(read_tum(options.trajectory), read_tum(options.reference), reference_options(options));
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

std::string frame_text(const CloudFrame& frame, bool no_align) {
  if (!frame.trajectory) return "the frames of cloud and truth taken as the same\n";
  const Pose2& T = frame.T_truth_map;
  return fmt::format("{}: {:.4f} m, {:.4f} m, {:.4f} deg; ATE of the trajectory {:.4f} m\n",
                     no_align ? "first poses made to agree" : "rigid alignment of the trajectory", T.x_m, T.y_m,
                     deg_from_rad(T.theta_rad), frame.trajectory->ate_m.mean);
}

double resolution_of(const std::string& text) {
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
  SceneErrorsJob job{.cloud = options.file,
                     .scene = options.scene,
                     .scene_folders = asset_folders("scenes"),
                     .frame = frame_of(options)};
  job.progress = [&line](std::uint64_t count, double share) { line.update(count, share); };
  job.stop = [] { return interrupted(); };
  const SceneErrors errors = scene_errors(job);
  line.clear();
  if (errors.distances.count() == 0 && !errors.interrupted) {
    throw InputError({options.file, 0}, "holds no point with finite coordinates");
  }
  std::string text = errors.distances.text() + frame_text(job.frame, options.no_align);
  if (errors.skipped > 0) text += fmt::format("{} points with values that are not finite left out\n", errors.skipped);
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
  HitErrorsJob job{.cloud = options.file, .hits = options.hits, .frame = frame_of(options)};
  if (!options.linkage.empty()) {
    job.quantisation = {resolve_linkage(options.linkage), resolution_of(options.resolution)};
  }
  job.progress = [&line](std::uint64_t count, double share) { line.update(count, share); };
  job.stop = [] { return interrupted(); };
  const HitErrors errors = hit_errors(job);
  line.clear();
  std::string text = errors.distances.text();
  text += fmt::format("each to the true hit of its beam, of which there are {}; {} points without one\n", errors.hits,
                      errors.without_hit);
  if (errors.bound) {
    text += fmt::format("quantisation bound, at most {:.6f} m: {} points beyond it, the worst at {:.1f} % of its own\n",
                        errors.bound->largest_bound_m, errors.bound->beyond, 100.0 * errors.bound->largest_share);
  }
  text += frame_text(job.frame, options.no_align);
  const Json json{{"metric", "hits"},
                  {"distance_m", errors.distances.json()},
                  {"hits", errors.hits},
                  {"without_hit", errors.without_hit},
                  {"quantisation_bound", bound_json(errors.bound)},
                  {"alignment", frame_json(job.frame)}};
  return finish(options, errors.distances, text, json, errors.interrupted);
}

int evaluate(const EvaluateOptions& options) {
  if (!options.scene.empty() || !options.hits.empty()) {
    check_cloud_usage(options);
    return options.scene.empty() ? against_hits(options) : against_scene(options);
  }
  if (!options.trajectory.empty() || !options.linkage.empty() || !options.resolution.empty() || !options.csv.empty()) {
    throw UsageError("--trajectory, --linkage, --resolution and --csv belong to a cloud: give --scene or --hits too");
  }
  if (options.relations.empty() && options.reference.empty()) {
    throw UsageError(
        "nothing to compare with: give --relations or --reference for a trajectory, --scene or --hits for "
        "a cloud");
  }
  return options.relations.empty() ? evaluate_against_reference(options) : evaluate_against_relations(options);
}

// What the file is compared with.
void add_truths(CLI::App& command, EvaluateOptions& chosen) {
  CLI::Option* relations = command.add_option("--relations", chosen.relations,
                                              "Verified relations, rows `t1 t2 x y z roll pitch yaw`, plain or gzip");
  CLI::Option* reference = command.add_option("--reference", chosen.reference, "True trajectory, TUM, plain or gzip");
  CLI::Option* scene = command.add_option("--scene", chosen.scene,
                                          "Of a cloud: distances to the surfaces of this scene, a file or a sample");
  CLI::Option* hits = command.add_option(
      "--hits", chosen.hits,
      "Of a cloud: distance of each point to the true hit of its own beam, from `simulate --truth-hits`");
  relations->type_name("FILE")->excludes(reference)->excludes(scene)->excludes(hits);
  scene->type_name("SCENE")->excludes(hits);
  reference->type_name("FILE");
  hits->type_name("FILE");
}

void add_cloud_options(CLI::App& command, EvaluateOptions& chosen) {
  command
      .add_option("--trajectory", chosen.trajectory,
                  "Of a cloud: its run's trajectory; with --reference it tells where the cloud is in the scene")
      ->type_name("FILE");
  command.add_option("--linkage", chosen.linkage, "With --hits: also tell the quantisation bound of this linkage")
      ->type_name("PRESET|FILE");
  command.add_option("--resolution", chosen.resolution, "With --linkage: the step of the ranges, as \"1 mm\"")
      ->type_name("LENGTH");
  command.add_option("--csv", chosen.csv, "Of a cloud: write the histogram of the distances")->type_name("FILE");
}

}  // namespace

void add_evaluate_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = add_command(app, "evaluate", "Errors of a trajectory or a cloud against the truth");
  command->add_option("file", options->file, "Trajectory, TUM: stamp x y z qx qy qz qw; or cloud, PLY or PCD")
      ->required();
  add_truths(*command, *options);
  add_quantity_option(*command, "--tolerance", options->tolerance_s, Unit::kSecond, {0.0, kMost_s},
                      "Stamps further apart do not match (default: 0.1 ms for relations, 10 ms for a reference)");
  add_quantity_option(*command, "--distance", options->distance_m, Unit::kMetre, {kLeastDistance_m, kMostDistance_m},
                      "Path length that the relative pose error is taken over")
      ->default_str(format_quantity(options->distance_m, Unit::kMetre));
  command->add_flag("--no-align", options->no_align,
                    "Against a reference: make the first poses agree instead of the best rigid alignment");
  add_cloud_options(*command, *options);
  command->add_flag("--json", options->json, "Print JSON");
  command->footer(
      "Relations: the error is the norm of the translation difference and the wrapped yaw difference, for all\n"
      "relations, those of at most 20 s and loops (Kuemmerle et al. 2009). Reference: absolute trajectory error\n"
      "(ATE) and relative pose error (RPE). Scene and hits: distances of the points, in metres.\n"
      "\n"
      "Examples:\n"
      "  gdtslam evaluate out/trajectory.tum --relations intel.relations.gz\n"
      "  gdtslam evaluate out/trajectory.tum --reference office.truth.tum --json\n"
      "  gdtslam evaluate out/cloud.ply --scene office-7f --trajectory out/trajectory.tum --reference "
      "office.truth.tum\n"
      "  gdtslam evaluate out/cloud.ply --hits boxes.truth.ply --trajectory out/trajectory.tum --reference "
      "boxes.truth.tum");
  command->callback([options, &context] { context.run = [options] { return evaluate(*options); }; });
}

}  // namespace gdtslam
