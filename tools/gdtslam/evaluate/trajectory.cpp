// Errors of a trajectory against relations or a reference, compared with the run's own covariances.
#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/io/json_file.hpp"
#include "engine/runs/evaluation/errors.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/streams/log_check.hpp"
#include "evaluate.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kRelationTolerance_s = 1e-4;

Json as_json(const RelationErrors& e) {
  return {{"translation_m", errors_json(e.translation_m)}, {"rotation_deg", errors_json(e.rotation_deg)}};
}

// `repeated`: relations whose stamps occur twice, so their poses are ambiguous.
std::string relation_text(const RelationReport& report, std::size_t repeated) {
  std::string text = errors_heading();
  text += errors_row("all", report.all.translation_m, "m") + errors_row("", report.all.rotation_deg, "deg");
  text += errors_row("short (<= 20 s)", report.short_term.translation_m, "m") +
          errors_row("", report.short_term.rotation_deg, "deg");
  text +=
      errors_row("loops (> 20 s)", report.loops.translation_m, "m") + errors_row("", report.loops.rotation_deg, "deg");
  text += fmt::format("worst relation: {:.6f} to {:.6f}\n", report.worst_t1_s, report.worst_t2_s);
  if (report.unmatched > 0) {
    text += fmt::format("{} relations have stamps that the trajectory does not have\n", report.unmatched);
  }
  if (repeated > 0) {
    text += fmt::format("{} relations are left out: the trajectory has their stamps twice, a clock stepped back\n",
                        repeated);
  }
  return text;
}

Json relation_json(const RelationReport& report, std::size_t repeated) {
  return {{"metric", "relations"},
          {"all", as_json(report.all)},
          {"short", as_json(report.short_term)},
          {"loops", as_json(report.loops)},
          {"unmatched", report.unmatched},
          {"repeated", repeated},
          {"worst", {{"t1_s", report.worst_t1_s}, {"t2_s", report.worst_t2_s}}}};
}

// A trajectory, with its poses' covariances if it is a run with closed loops.
struct Evaluated {
  Trajectory trajectory;
  std::optional<std::vector<PoseCovariance>> covariances;
  bool is_run = false;
};

Evaluated read_evaluated(const EvaluateOptions& options) {
  if (!RunReader::is_run(options.file)) {
    if (!options.noise.empty()) {
      throw UsageError("--noise is for what a run states: give the run's folder in place of a trajectory");
    }
    return {given_trajectory(options.file), {}, false};
  }
  const RunReader run(options.file);
  return {run.trajectory(), run.covariances(), true};
}

std::string shares_row(const std::string& name, const std::array<double, kStatedSigmas>& shares) {
  return fmt::format("{:<16} {:>7.1f} % {:>7.1f} % {:>7.1f} %", name, 100.0 * shares[0], 100.0 * shares[1],
                     100.0 * shares[2]);
}

std::string shares_text(const std::string& name, const StatedShares& shares, const StatedTheory& theory) {
  if (shares.count == 0) return "";
  return shares_row(name, {shares.share(1), shares.share(2), shares.share(3)}) +
         fmt::format("  {:.2f} times what is stated\n", shares.factor) + shares_row("  if it is right", theory.shares) +
         "\n";
}

Json shares_json(const StatedShares& shares, const StatedTheory& theory) {
  return {{"count", shares.count},
          {"within", {shares.share(1), shares.share(2), shares.share(3)}},
          {"theory", theory.shares},
          {"factor", shares.count > 0 ? Json(shares.factor) : Json()}};
}

TruthNoise parse_noise(const std::string& text) {
  if (text.empty()) return {};
  const auto [length_m, angle_rad] = length_and_angle("--noise", text, "2cm/0.5deg");
  return {length_m, angle_rad};
}

// Prints the report, with the run's own covariances if it has any.
void print_report(const EvaluateOptions& options, const Evaluated& evaluated, std::string text, Json json,
                  const std::optional<StatedReport>& stated) {
  const TruthNoise noise = parse_noise(options.noise);
  if (stated) {
    text += stated_text(*stated, noise);
    json["stated"] = stated_json(*stated, noise);
  } else if (evaluated.is_run && !evaluated.covariances) {
    text += "stated           nothing: the run closed no loops\n";
  }
  print_result(options.json ? json_text(json) : text);
}

int evaluate_against_relations(const EvaluateOptions& options) {
  const Evaluated evaluated = read_evaluated(options);
  const std::vector<Relation> given = read_relations(options.relations);
  const double tolerance_s = options.tolerance_s < 0.0 ? kRelationTolerance_s : options.tolerance_s;
  const auto [relations, report] =
      check_relations(evaluated.trajectory, given, options.relations, options.file, tolerance_s);
  const std::size_t repeated = given.size() - relations.size();
  std::optional<StatedReport> stated;
  if (evaluated.covariances) {
    stated =
        stated_errors(evaluated.trajectory, *evaluated.covariances, relations, parse_noise(options.noise), tolerance_s);
  }
  print_report(options, evaluated, relation_text(report, repeated), relation_json(report, repeated), stated);
  return static_cast<int>(ExitCode::kDone);
}

std::string reference_text(const ReferenceReport& report, const ReferenceOptions& options) {
  std::string text = errors_heading();
  text += errors_row("ATE", report.ate_m, "m") + errors_row("", report.ate_rotation_deg, "deg");
  text += errors_row(fmt::format("RPE per {:g} m", options.rpe_distance_m), report.rpe_m, "m");
  text += errors_row("", report.rpe_rotation_deg, "deg");
  text += fmt::format("{}: {:.4f} m, {:.4f} m, {:.4f} deg\n",
                      options.align ? "rigid alignment (least squares)" : "first poses made to agree",
                      report.T_reference_estimate.x_m, report.T_reference_estimate.y_m,
                      deg_from_rad(report.T_reference_estimate.theta_rad));
  if (report.rpe_m.count == 0) {
    text += fmt::format("no RPE: no two poses are {:g} m of reference path apart\n", options.rpe_distance_m);
  }
  if (report.unmatched > 0) {
    text += fmt::format("{} {} no counterpart in the reference\n", plural(report.unmatched, "pose"),
                        report.unmatched == 1 ? "has" : "have");
  }
  return text;
}

Json reference_json(const ReferenceReport& report, const ReferenceOptions& options) {
  const Pose2& T = report.T_reference_estimate;
  return {
      {"metric", "reference"},
      {"ate", {{"translation_m", errors_json(report.ate_m)}, {"rotation_deg", errors_json(report.ate_rotation_deg)}}},
      {"rpe",
       {{"distance_m", options.rpe_distance_m},
        {"translation_m", errors_json(report.rpe_m)},
        {"rotation_deg", errors_json(report.rpe_rotation_deg)}}},
      {"aligned", options.align},
      {"T_reference_estimate", {{"x_m", T.x_m}, {"y_m", T.y_m}, {"theta_rad", T.theta_rad}}},
      {"matched", report.matched},
      {"unmatched", report.unmatched}};
}

// If no stamps match, the stamps of one file may have another unit.
ReferenceReport reference_report(const EvaluateOptions& options, const Trajectory& estimate,
                                 const Trajectory& reference, const ReferenceOptions& how) {
  try {
    return evaluate_reference(estimate, reference, how);
  } catch (const InputError& error) {
    for (const auto& [file, trajectory] : {std::pair(options.file, &estimate), {options.reference, &reference}}) {
      const std::string question = question_of_unit(*trajectory);
      if (!question.empty()) throw InputError(fmt::format("{} In {}, {}", error.what(), file, question));
    }
    throw;
  }
}

int evaluate_against_reference(const EvaluateOptions& options) {
  const ReferenceOptions reference = reference_options(options);
  const Evaluated evaluated = read_evaluated(options);
  const Trajectory truth = given_trajectory(options.reference);
  const ReferenceReport report = reference_report(options, evaluated.trajectory, truth, reference);
  std::optional<StatedReport> stated;
  if (evaluated.covariances && reference.align) {
    stated = stated_errors(evaluated.trajectory, *evaluated.covariances, truth, report.T_reference_estimate,
                           parse_noise(options.noise), reference.tolerance_s);
  }
  std::string text = reference_text(report, reference);
  if (evaluated.covariances && !reference.align) text += "stated           not compared: it is of the best alignment\n";
  print_report(options, evaluated, text, reference_json(report, reference), stated);
  return static_cast<int>(ExitCode::kDone);
}
}  // namespace

std::string errors_heading() { return "                    count      mean       std    median      rmse       max\n"; }

// Without a sample there is no error to report; a zero would look like a perfect result.
std::string errors_row(const std::string& name, const ErrorSummary& e, const std::string& unit) {
  if (e.count == 0) {
    return fmt::format("{:<16} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9}  {}\n", name, 0, "-", "-", "-", "-", "-", unit);
  }
  return fmt::format("{:<16} {:>8} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f}  {}\n", name, e.count, e.mean,
                     e.deviation, e.median, e.rmse, e.max, unit);
}

Json errors_json(const ErrorSummary& e) {
  const auto value = [&e](double number) { return e.count > 0 ? Json(number) : Json(); };
  return {{"count", e.count},          {"mean", value(e.mean)}, {"std", value(e.deviation)},
          {"median", value(e.median)}, {"rmse", value(e.rmse)}, {"max", value(e.max)}};
}

std::string stated_text(const StatedReport& report, const TruthNoise& noise) {
  std::string text = "stated           1 sigma   2 sigma   3 sigma  median error\n";
  text += shares_text("pose", report.pose, kPoseTheory) + shares_text("position", report.position, kPositionTheory);
  if (noise.sigma_m > 0.0 || noise.sigma_rad > 0.0) {
    text += fmt::format("the truth's own standard deviation taken as {:g} m and {:g} deg\n", noise.sigma_m,
                        deg_from_rad(noise.sigma_rad));
  }
  if (report.unstated > 0) text += fmt::format("{} errors have no stated deviation\n", report.unstated);
  return text;
}

Json stated_json(const StatedReport& report, const TruthNoise& noise) {
  return {{"pose", shares_json(report.pose, kPoseTheory)},
          {"position", shares_json(report.position, kPositionTheory)},
          {"unstated", report.unstated},
          {"noise_m", noise.sigma_m},
          {"noise_deg", deg_from_rad(noise.sigma_rad)}};
}

LengthAndAngle length_and_angle(const std::string& option, const std::string& text, const std::string& example) {
  const std::size_t mark = text.find('/');
  if (mark == std::string::npos) {
    throw UsageError(option + ": '" + text + "' is not LENGTH/ANGLE, for example " + example);
  }
  const LengthAndAngle found{quantity_of(option, text.substr(0, mark), Unit::kMetre),
                             quantity_of(option, text.substr(mark + 1), Unit::kRadian)};
  constexpr double kMost_m = 100.0;
  if (!(found.length_m >= 0.0 && found.length_m <= kMost_m && found.angle_rad >= 0.0 && found.angle_rad <= kPi)) {
    throw UsageError(option + ": '" + text + "' is out of range: from 0/0 to 100m/180deg");
  }
  return found;
}

ReferenceOptions reference_options(const EvaluateOptions& options) {
  ReferenceOptions reference{.rpe_distance_m = options.distance_m, .align = !options.no_align};
  if (options.tolerance_s >= 0.0) reference.tolerance_s = options.tolerance_s;
  return reference;
}

int evaluate_trajectory(const EvaluateOptions& options) {
  return options.relations.empty() ? evaluate_against_reference(options) : evaluate_against_relations(options);
}

}  // namespace gdtslam
