// gdtslam localize: where scans of a log were taken in a map, without odometry and with a proof.
#include <fmt/format.h>

#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "interrupt.hpp"
#include "localize_run.hpp"
#include "progress.hpp"
#include "scan_stream.hpp"
#include "settings.hpp"
#include "whole_number.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

struct LocalizeOptions {
  std::string map;
  std::string log;
  std::uint64_t scan = 0;
  std::uint64_t every = 0;  ///< 0: one scan alone
  double gap_mm = 5.0;
  double max_seconds = 0.0;  ///< 0: no limit
  bool no_runner_up = false;
  bool lenient = false;
  bool json = false;
  bool quiet = false;
  std::string trajectory;  ///< to be written; empty: none
  SettingsOptions settings;
};

struct Localized {
  std::vector<LocalizedScan> scans;
  std::vector<std::uint64_t> without_returns;  ///< indices of scans with too few
  bool interrupted = false;
};

// From the scan asked for on; all of them, every so many, or the one.
Localized localize_scans(const LocalizeOptions& options, const Localizer& localizer) {
  ReadOptions read;
  read.lenient = options.lenient;
  ScanStream stream({options.log}, read, {.skip = options.scan, .count = std::numeric_limits<std::uint64_t>::max()});
  ProgressLine progress("scans", options.quiet || options.json);
  Localized all;
  std::uint64_t index = options.scan;
  for (; !interrupted(); ++index) {
    const std::optional<ScanRecord> record = stream.next();
    if (!record) break;
    if (options.every > 1 && (index - options.scan) % options.every != 0) continue;
    const std::optional<LocalizedScan> found = localizer.localize(record->scan, index);
    if (found) {
      all.scans.push_back(*found);
    } else {
      all.without_returns.push_back(index);
    }
    progress.update(all.scans.size(), stream.progress());
    if (options.every == 0) break;
  }
  all.interrupted = interrupted();
  if (all.scans.empty() && all.without_returns.empty() && !all.interrupted) {
    throw InputError({options.log, 0}, fmt::format("has no scan {}: {} were read", options.scan, stream.scans_read()));
  }
  return all;
}

Json pose_json(const CertifiedResult& found) {
  return {{"x_m", found.T_map_base.x_m},
          {"y_m", found.T_map_base.y_m},
          {"theta_rad", found.T_map_base.theta_rad},
          {"mean_distance_m", found.mean_cost_m},
          {"mean_bound_m", found.mean_bound_m},
          {"gap_m", found.gap_m},
          {"certified", found.certified()},
          {"stop", name_of(found.stop)},
          {"boxes", found.boxes},
          {"evaluations", found.evaluations}};
}

Json scan_json(const LocalizedScan& scan) {
  Json json{{"scan", scan.index}, {"stamp_s", scan.stamp_s}, {"points", scan.points}, {"wall_s", scan.wall_s}};
  json.update(pose_json(scan.best));
  const bool has_other = scan.runner_up && scan.runner_up->stop != CertifiedStop::kNothingAllowed;
  json["runner_up"] = has_other ? pose_json(*scan.runner_up) : Json();
  json["ambiguous"] = scan.runner_up ? Json(scan.is_ambiguous()) : Json();
  return json;
}

std::string json_text(const LocalizeOptions& options, const Localizer& localizer, const Localized& all) {
  Json scans = Json::array();
  for (const LocalizedScan& scan : all.scans) scans.push_back(scan_json(scan));
  const PoseWindow& window = localizer.window();
  const Json report{{"map", localizer.file()},
                    {"log", options.log},
                    {"gap_m", options.gap_mm / 1000.0},
                    {"window",
                     {{"x_m", {window.centre.x_m - window.half_x_m, window.centre.x_m + window.half_x_m}},
                      {"y_m", {window.centre.y_m - window.half_y_m, window.centre.y_m + window.half_y_m}}}},
                    {"scans", scans},
                    {"without_returns", all.without_returns},
                    {"interrupted", all.interrupted}};
  return report.dump(2) + "\n";
}

std::string proof_text(const CertifiedResult& found) {
  if (found.certified()) return fmt::format("no pose is better by more than {:.2f} mm", 1000.0 * found.gap_m);
  return fmt::format("not proven ({}): a pose may be better by {:.2f} mm", name_of(found.stop), 1000.0 * found.gap_m);
}

std::string runner_up_text(const LocalizedScan& scan) {
  if (!scan.runner_up) return "";
  if (scan.runner_up->stop == CertifiedStop::kNothingAllowed) return "  elsewhere: no pose in the map\n";
  const Pose2 apart = between(scan.best.T_map_base, scan.runner_up->T_map_base);
  return fmt::format(
      "  elsewhere, {:.2f} m and {:.1f} deg away: mean distance {:.1f} mm, nowhere less than {:.1f} mm{}\n",
      apart.translation().norm(), std::abs(deg_from_rad(apart.theta_rad)), 1000.0 * scan.runner_up->mean_cost_m,
      1000.0 * scan.runner_up->mean_bound_m, scan.is_ambiguous() ? "; AMBIGUOUS: it may be as good" : "");
}

std::string scan_text(const LocalizedScan& scan) {
  const Pose2& T = scan.best.T_map_base;
  return fmt::format("scan {} at {:.6f} s: x {:.3f} m, y {:.3f} m, heading {:.2f} deg\n", scan.index, scan.stamp_s,
                     T.x_m, T.y_m, deg_from_rad(T.theta_rad)) +
         fmt::format("  mean distance {:.1f} mm of {} points; {}; {:.0f} ms\n", 1000.0 * scan.best.mean_cost_m,
                     scan.points, proof_text(scan.best), 1000.0 * scan.wall_s) +
         runner_up_text(scan);
}

std::string text_of(const Localized& all) {
  std::string text;
  std::size_t certified = 0;
  std::size_t ambiguous = 0;
  for (const LocalizedScan& scan : all.scans) {
    text += scan_text(scan);
    certified += scan.best.certified() ? 1U : 0U;
    ambiguous += scan.is_ambiguous() ? 1U : 0U;
  }
  for (const std::uint64_t index : all.without_returns) text += fmt::format("scan {}: too few returns\n", index);
  if (all.scans.size() > 1) {
    text += fmt::format("{} scans, {} proven, {} ambiguous\n", all.scans.size(), certified, ambiguous);
  }
  return text;
}

int localize(const LocalizeOptions& options) {
  const Settings settings = load_settings(options.settings);
  LocalizeLimits limits{.gap_m = options.gap_mm / 1000.0, .max_seconds = {}, .with_runner_up = !options.no_runner_up};
  if (options.max_seconds > 0.0) limits.max_seconds = options.max_seconds;
  const Localizer localizer(options.map, settings.mapper, limits);
  const Localized all = localize_scans(options, localizer);
  if (!options.trajectory.empty()) {
    Trajectory trajectory;
    for (const LocalizedScan& scan : all.scans) trajectory.push_back({scan.stamp_s, scan.best.T_map_base});
    write_tum(options.trajectory, trajectory);
  }
  print_result(options.json ? json_text(options, localizer, all) : text_of(all));
  if (all.interrupted) return static_cast<int>(ExitCode::kInterrupted);
  return static_cast<int>(all.scans.empty() ? ExitCode::kBadInput : ExitCode::kDone);
}

void add_choices(CLI::App& command, LocalizeOptions& chosen) {
  command.add_option("--scan", chosen.scan, "Index of the scan, from 0; with --every the first one")
      ->type_name("N")
      ->check(whole_number_from(0))
      ->capture_default_str();
  command.add_option("--every", chosen.every, "Go on to the end of the log with every N-th scan")
      ->type_name("N")
      ->check(whole_number_from(1));
  command.add_option("--gap", chosen.gap_mm, "Prove that no pose has a mean distance smaller by more than this")
      ->type_name("MM")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_option("--max-time", chosen.max_seconds, "Give a search up after this long (default: never)")
      ->type_name("SECONDS")
      ->check(CLI::PositiveNumber);
  command.add_flag("--no-runner-up", chosen.no_runner_up, "Do not look for the best pose elsewhere");
  command.add_option("-o,--output", chosen.trajectory, "Write the poses as a trajectory, TUM")->type_name("FILE");
}

}  // namespace

void add_localize_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<LocalizeOptions>();
  CLI::App* command =
      app.add_subcommand("localize", "The pose of scans in a whole map, without odometry, with a proof");
  command->add_option("map", options->map, "Run folder of `gdtslam map`, or its gdt.yaml")->required();
  command->add_option("log", options->log, "Log with the scans, plain or gzip")->required();
  add_choices(*command, *options);
  command->add_flag("--lenient", options->lenient, "Count and skip malformed lines of the log");
  command->add_flag("--json", options->json, "Print JSON");
  command->add_flag("-q,--quiet", options->quiet, "No progress");
  add_settings_options(*command, options->settings);
  command->footer(
      "All poses over the known part of the map are searched, in every heading, by branch and bound: the result is "
      "the\n"
      "pose of least mean distance between the scan's points and the map's obstacles, up to the gap. Elsewhere means 1 "
      "m\n"
      "or 20 degrees away; a scan is ambiguous when a pose elsewhere may be as good.\n"
      "\n"
      "Examples:\n"
      "  gdtslam localize intel intel.clf.gz --scan 5000\n"
      "  gdtslam localize intel/gdt.yaml today.clf.gz --every 50 -o poses.tum --json");
  command->callback([&context, options] { context.run = [options] { return localize(*options); }; });
}

}  // namespace gdtslam
