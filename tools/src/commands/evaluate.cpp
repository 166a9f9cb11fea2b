// gdtslam evaluate: how far a trajectory is from what somebody verified.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "commands.hpp"
#include "console.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

struct EvaluateOptions {
  std::string trajectory;
  std::string relations;
  std::string reference;
  double tolerance_s = -1.0;  ///< negative: the default of the metric
  double distance_m = ReferenceOptions{}.rpe_distance_m;
  bool no_align = false;
  bool json = false;
};

constexpr const char* kHeading = "                    count      mean       std    median      rmse       max\n";

// Without a sample there is no error to state; a zero would look like a perfect one.
std::string row(const std::string& name, const ErrorSummary& e, const std::string& unit) {
  if (e.count == 0) {
    return fmt::format("{:<16} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9}  {}\n", name, 0, "-", "-", "-", "-", "-", unit);
  }
  return fmt::format("{:<16} {:>8} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f}  {}\n", name, e.count, e.mean,
                     e.deviation, e.median, e.rmse, e.max, unit);
}

Json json_of(const ErrorSummary& e) {
  const auto value = [&e](double number) { return e.count > 0 ? Json(number) : Json(); };
  return {{"count", e.count},          {"mean", value(e.mean)}, {"std", value(e.deviation)},
          {"median", value(e.median)}, {"rmse", value(e.rmse)}, {"max", value(e.max)}};
}

Json json_of(const RelationErrors& e) {
  return {{"translation_m", json_of(e.translation_m)}, {"rotation_deg", json_of(e.rotation_deg)}};
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
          {"all", json_of(report.all)},
          {"short", json_of(report.short_term)},
          {"loops", json_of(report.loops)},
          {"unmatched", report.unmatched},
          {"worst", {{"t1_s", report.worst_t1_s}, {"t2_s", report.worst_t2_s}}}};
}

int evaluate_against_relations(const EvaluateOptions& options) {
  const Trajectory trajectory = read_tum(options.trajectory);
  const std::vector<Relation> relations = read_relations(options.relations);
  const RelationReport report = options.tolerance_s < 0.0
                                    ? evaluate_relations(trajectory, relations)
                                    : evaluate_relations(trajectory, relations, options.tolerance_s);
  if (report.all.translation_m.count == 0) {
    throw InputError({options.relations, 0},
                     fmt::format("none of its {} relations has stamps of {}; do both belong to the same log?",
                                 relations.size(), options.trajectory));
  }
  print_result(options.json ? relation_json(report).dump(2) + "\n" : relation_text(report));
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
          {"ate", {{"translation_m", json_of(report.ate_m)}, {"rotation_deg", json_of(report.ate_rotation_deg)}}},
          {"rpe",
           {{"distance_m", options.rpe_distance_m},
            {"translation_m", json_of(report.rpe_m)},
            {"rotation_deg", json_of(report.rpe_rotation_deg)}}},
          {"aligned", options.align},
          {"T_reference_estimate", {{"x_m", T.x_m}, {"y_m", T.y_m}, {"theta_rad", T.theta_rad}}},
          {"matched", report.matched},
          {"unmatched", report.unmatched}};
}

int evaluate_against_reference(const EvaluateOptions& options) {
  ReferenceOptions reference{.rpe_distance_m = options.distance_m, .align = !options.no_align};
  if (options.tolerance_s >= 0.0) reference.tolerance_s = options.tolerance_s;
  const ReferenceReport report =
      evaluate_reference(read_tum(options.trajectory), read_tum(options.reference), reference);
  print_result(options.json ? reference_json(report, reference).dump(2) + "\n" : reference_text(report, reference));
  return static_cast<int>(ExitCode::kDone);
}

int evaluate(const EvaluateOptions& options) {
  return options.relations.empty() ? evaluate_against_reference(options) : evaluate_against_relations(options);
}

}  // namespace

void add_evaluate_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = app.add_subcommand("evaluate", "Errors of a trajectory against relations or a reference");
  command->add_option("trajectory", options->trajectory, "TUM file: stamp x y z qx qy qz qw")->required();
  CLI::Option_group* against = command->add_option_group("against", "One of");
  against
      ->add_option("--relations", options->relations,
                   "Verified relations, rows `t1 t2 x y z roll pitch yaw`, plain or gzip")
      ->type_name("FILE");
  against->add_option("--reference", options->reference, "True trajectory, TUM, plain or gzip")->type_name("FILE");
  against->require_option(1);
  command
      ->add_option("--tolerance", options->tolerance_s,
                   "Stamps further apart do not match (default: 0.0001 s for relations, 0.01 s for a reference)")
      ->type_name("SECONDS")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--distance", options->distance_m, "Path length that the relative pose error is taken over")
      ->type_name("METRES")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--no-align", options->no_align,
                    "Against a reference: make the first poses agree instead of the best rigid alignment");
  command->add_flag("--json", options->json, "Print JSON");
  command->footer(
      "Relations: the error is the norm of the translation difference and the wrapped yaw difference, for all\n"
      "relations, those of at most 20 s and loops (Kuemmerle et al. 2009). Reference: absolute trajectory error\n"
      "(ATE) and relative pose error (RPE).\n"
      "\n"
      "Examples:\n"
      "  gdtslam evaluate out/trajectory.tum --relations intel.relations.gz\n"
      "  gdtslam evaluate out/trajectory.tum --reference office.truth.tum --json");
  command->callback([options, &context] { context.run = [options] { return evaluate(*options); }; });
}

}  // namespace gdtslam
