// gdtslam evaluate: errors of a trajectory, of poses found in a map or of a cloud; dimensions of objects in a cloud.
#include <CLI/App.hpp>

#include <filesystem>
#include <memory>
#include <string>

#include "engine/runs/evaluation/pose_table.hpp"
#include "evaluate.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

constexpr double kMost_s = 1e9;
constexpr double kLeastDistance_m = 1e-3;
constexpr double kMostDistance_m = 1e9;

int evaluate_table(const EvaluateOptions& options) {
  if (options.reference.empty()) throw UsageError("nothing to compare with: give --reference");
  if (!options.noise.empty()) throw UsageError("--noise is for what a run states, not for a table");
  return evaluate_poses(options);
}

int evaluate(const EvaluateOptions& options) {
  if (options.measure.job.boxes || options.measure.job.planes) return measure_boxes_and_planes(options);
  if (!options.scene.empty() || !options.hits.empty()) {
    if (!options.noise.empty()) throw UsageError("--noise is for what a run states, not for a cloud");
    return evaluate_cloud(options);
  }
  std::error_code ignored;
  const bool is_file = std::filesystem::is_regular_file(options.file, ignored);
  if (is_file && is_pose_table(options.file)) return evaluate_table(options);
  if (!options.within.empty() || options.leave_out_s >= 0.0) {
    throw UsageError("--within and --leave-out are for a table of 'gdtslam localize'");
  }
  if (!options.trajectory.empty() || !options.linkage.empty() || !options.resolution.empty() || !options.csv.empty()) {
    throw UsageError("--trajectory, --linkage, --resolution and --csv belong to a cloud: give --scene or --hits too");
  }
  if (options.relations.empty() && options.reference.empty()) {
    throw UsageError(
        "nothing to compare with: give --relations or --reference for a trajectory, --scene or --hits for "
        "a cloud, or --boxes or --planes to measure one");
  }
  return evaluate_trajectory(options);
}

// Adds the options for the truth that the file is compared with.
void add_truths(CLI::App& command, EvaluateOptions& chosen) {
  CLI::Option* relations = command.add_option("--relations", chosen.relations,
                                              "Verified relations, rows `t1 t2 x y z roll pitch yaw`, plain or gzip");
  CLI::Option* reference =
      command.add_option("--reference", chosen.reference, "True trajectory, TUM, plain or gzip, or a run");
  CLI::Option* scene = command.add_option(
      "--scene", chosen.scene, "Scene, a file or a sample, to whose surfaces the distances of a cloud are taken");
  CLI::Option* hits = command.add_option(
      "--hits", chosen.hits,
      "True hits from `simulate --truth-hits`: each point of a cloud is compared with that of its own beam");
  relations->type_name("FILE")->excludes(reference)->excludes(scene)->excludes(hits);
  scene->type_name("SCENE")->excludes(hits);
  reference->type_name("FILE");
  offer_words(scene, {"office-loop", "corridor", "office-3f", "office-7f", "three-boxes", "wall", "walls"});
  hits->type_name("FILE");
}

void add_table_options(CLI::App& command, EvaluateOptions& chosen) {
  command
      .add_option("--within", chosen.within,
                  "Distance and angle to the reference within which a pose of a table of localize is right [10cm/1deg]")
      ->type_name("D/A");
  add_quantity_option(
      command, "--leave-out", chosen.leave_out_s, Unit::kSecond, {0.0, kMost_s},
      "Leave out scans of a table of localize that were taken this near in time to one that went into the map;\n"
      "0: those themselves. The run of the map is --trajectory, else --reference");
}

void add_cloud_options(CLI::App& command, EvaluateOptions& chosen) {
  command
      .add_option(
          "--trajectory", chosen.trajectory,
          "Trajectory of the run that a cloud is of, or in whose map poses were found; with --reference it tells how\n"
          "that map lies in the frame of the truth [that of the run, where FILE is a run]")
      ->type_name("FILE");
  command.add_option("--linkage", chosen.linkage, "With --hits: also tell the quantisation bound of this linkage")
      ->type_name("PRESET|FILE");
  command.add_option("--resolution", chosen.resolution, "With --linkage: the step of the ranges, as \"1 mm\"")
      ->type_name("LENGTH");
  command.add_option("--csv", chosen.csv, "Write the histogram of the distances of a cloud, or what was measured")
      ->type_name("FILE");
}

}  // namespace

void add_evaluate_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = add_command(
      app, "evaluate", "Errors of a trajectory, poses or a cloud against the truth; boxes and planes of a cloud");
  command
      ->add_option("file", options->file,
                   "Folder of a run; trajectory, TUM: stamp x y z qx qy qz qw; table of localize; or cloud, PLY or PCD")
      ->required()
      ->type_name("RUN|FILE");
  add_truths(*command, *options);
  add_quantity_option(*command, "--tolerance", options->tolerance_s, Unit::kSecond, {0.0, kMost_s},
                      "Stamps further apart do not match (default: 0.1 ms for relations, 10 ms for a reference)");
  add_quantity_option(*command, "--distance", options->distance_m, Unit::kMetre, {kLeastDistance_m, kMostDistance_m},
                      "Path length that the relative pose error is taken over")
      ->default_str(format_quantity(options->distance_m, Unit::kMetre))
      ->excludes("--relations");
  command
      ->add_flag("--no-align", options->no_align,
                 "Against a reference: make the first poses agree instead of the best rigid alignment")
      ->excludes("--relations");
  command
      ->add_option(
          "--noise", options->noise,
          "Standard deviation of the truth itself, as 2cm/0.5deg, where what a run states is compared with the errors\n"
          "[0/0]")
      ->type_name("D/A");
  add_table_options(*command, *options);
  add_cloud_options(*command, *options);
  add_force_option(*command, options->force);
  add_measure_options(*command, options->measure);
  command->add_flag("--json", options->json, "Print JSON");
  command->footer(
      "Relations: the error is the norm of the translation difference and the wrapped yaw difference, for all\n"
      "relations, those of at most 20 s and loops (Kuemmerle et al. 2009). Reference: absolute trajectory error\n"
      "(ATE) and relative pose error (RPE). Scene and hits: distances of the points, in metres.\n"
      "Of a run with closed loops also the share of errors within one, two and three of the standard deviations that\n"
      "it states (covariance.csv), and what that share is if they are right.\n"
      "Table of localize: the share of poses within the limits, with its 95 % interval (Wilson 1927), by verdict.\n"
      "Boxes and planes: a value stands with its standard deviation, and whether both of its ends were seen. Map with\n"
      "cloud.voxel=0: all beams that met or passed an edge of a box tell where it is.\n"
      "\n"
      "Examples:\n"
      "  gdtslam evaluate out --relations intel.relations.gz\n"
      "  gdtslam evaluate out --relations intel.relations.gz --noise 2cm/0.5deg\n"
      "  gdtslam evaluate out/trajectory.tum --reference office.truth.tum --json\n"
      "  gdtslam evaluate out --scene office-7f --reference office.truth.tum\n"
      "  gdtslam evaluate out --hits boxes.truth.ply --reference boxes.truth.tum\n"
      "  gdtslam evaluate other.pcd --scene office-7f --trajectory other.tum --reference office.truth.tum\n"
      "  gdtslam evaluate poses.csv --reference office --leave-out 0.5s\n"
      "  gdtslam evaluate poses.csv --trajectory office --reference office.truth.tum --within 10cm/1deg\n"
      "  gdtslam evaluate run --boxes --picture boxes.svg --csv boxes.csv\n"
      "  gdtslam evaluate room.pcd --planes --thickness 5cm --min-points 1000");
  command->callback([options, &context] { context.run = [options] { return evaluate(*options); }; });
}

}  // namespace gdtslam
