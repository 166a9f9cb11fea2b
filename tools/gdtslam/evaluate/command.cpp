// gdtslam evaluate: how far a trajectory is from what somebody verified, or a cloud from the truth.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "evaluate_cloud.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/quantity_option.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

struct EvaluateOptions {
  std::string file;  ///< a trajectory, or with scene or hits a cloud
  std::string relations;
  double distance_m = ReferenceOptions{}.rpe_distance_m;
  EvaluateCloudOptions cloud;  ///< and what a trajectory's evaluation shares with it
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
  const RelationReport report = options.cloud.tolerance_s < 0.0
                                    ? evaluate_relations(trajectory, relations)
                                    : evaluate_relations(trajectory, relations, options.cloud.tolerance_s);
  if (report.all.translation_m.count == 0) {
    throw InputError({options.relations, 0},
                     fmt::format("none of its {} relations has stamps of {}; do both belong to the same log?",
                                 relations.size(), options.file));
  }
  print_result(options.cloud.json ? relation_json(report).dump(2) + "\n" : relation_text(report));
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

int evaluate_against_reference(const EvaluateOptions& options) {
  ReferenceOptions reference{.rpe_distance_m = options.distance_m, .align = !options.cloud.no_align};
  if (options.cloud.tolerance_s >= 0.0) reference.tolerance_s = options.cloud.tolerance_s;
  const ReferenceReport report =
      evaluate_reference(read_tum(options.file), read_tum(options.cloud.reference), reference);
  print_result(options.cloud.json ? reference_json(report, reference).dump(2) + "\n"
                                  : reference_text(report, reference));
  return static_cast<int>(ExitCode::kDone);
}

int evaluate(const EvaluateOptions& options) {
  const EvaluateCloudOptions& cloud = options.cloud;
  if (!cloud.scene.empty() || !cloud.hits.empty()) {
    EvaluateCloudOptions job = cloud;
    job.cloud = options.file;
    return evaluate_cloud(job);
  }
  if (!cloud.trajectory.empty() || !cloud.linkage.empty() || !cloud.resolution.empty() || !cloud.csv.empty()) {
    throw UsageError("--trajectory, --linkage, --resolution and --csv belong to a cloud: give --scene or --hits too");
  }
  if (options.relations.empty() && cloud.reference.empty()) {
    throw UsageError(
        "nothing to compare with: give --relations or --reference for a trajectory, --scene or --hits for a cloud");
  }
  return options.relations.empty() ? evaluate_against_reference(options) : evaluate_against_relations(options);
}

// What the file is compared with.
void add_truths(CLI::App& command, EvaluateOptions& chosen) {
  EvaluateCloudOptions& cloud = chosen.cloud;
  CLI::Option* relations = command.add_option("--relations", chosen.relations,
                                              "Verified relations, rows `t1 t2 x y z roll pitch yaw`, plain or gzip");
  CLI::Option* reference = command.add_option("--reference", cloud.reference, "True trajectory, TUM, plain or gzip");
  CLI::Option* scene = command.add_option("--scene", cloud.scene,
                                          "Of a cloud: distances to the surfaces of this scene, a file or a sample");
  CLI::Option* hits = command.add_option(
      "--hits", cloud.hits,
      "Of a cloud: distance of each point to the true hit of its own beam, from `simulate --truth-hits`");
  relations->type_name("FILE")->excludes(reference)->excludes(scene)->excludes(hits);
  scene->type_name("SCENE")->excludes(hits);
  reference->type_name("FILE");
  hits->type_name("FILE");
}

void add_cloud_options(CLI::App& command, EvaluateCloudOptions& cloud) {
  command
      .add_option("--trajectory", cloud.trajectory,
                  "Of a cloud: its run's trajectory; with --reference it tells where the cloud is in the scene")
      ->type_name("FILE");
  command.add_option("--linkage", cloud.linkage, "With --hits: also tell the quantisation bound of this linkage")
      ->type_name("PRESET|FILE");
  command.add_option("--resolution", cloud.resolution, "With --linkage: the step of the ranges, as \"1 mm\"")
      ->type_name("LENGTH");
  command.add_option("--csv", cloud.csv, "Of a cloud: write the histogram of the distances")->type_name("FILE");
}

}  // namespace

void add_evaluate_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = add_command(app, "evaluate", "Errors of a trajectory or a cloud against the truth");
  command->add_option("file", options->file, "Trajectory, TUM: stamp x y z qx qy qz qw; or cloud, PLY or PCD")
      ->required();
  add_truths(*command, *options);
  add_quantity_option(*command, "--tolerance", options->cloud.tolerance_s, Unit::kSecond, {0.0, kMost_s},
                      "Stamps further apart do not match (default: 0.1 ms for relations, 10 ms for a reference)");
  add_quantity_option(*command, "--distance", options->distance_m, Unit::kMetre, {kLeastDistance_m, kMostDistance_m},
                      "Path length that the relative pose error is taken over")
      ->default_str(format_quantity(options->distance_m, Unit::kMetre));
  command->add_flag("--no-align", options->cloud.no_align,
                    "Against a reference: make the first poses agree instead of the best rigid alignment");
  add_cloud_options(*command, options->cloud);
  command->add_flag("--json", options->cloud.json, "Print JSON");
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
