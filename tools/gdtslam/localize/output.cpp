#include "tools/gdtslam/localize/localize.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/runs/localizer/localize_log.hpp"
#include "gdtslam/core/angle.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

std::string proof_text(const CertifiedResult& found) {
  if (found.certified()) return fmt::format("no pose is better by more than {:.2f} mm", 1000.0 * found.gap_m);
  if (found.stop == CertifiedStop::kBoundReached)
    return fmt::format("no pose has less than {:.1f} mm", 1000.0 * found.mean_bound_m);
  return fmt::format("not proven ({}): a pose may be better by {:.2f} mm", to_string(found.stop), 1000.0 * found.gap_m);
}

std::string runner_up_text(const LocalizedScan& scan) {
  if (scan.is_elsewhere_open) return "  elsewhere: not known, the search for it was cut short; it may be as good\n";
  if (!scan.runner_up) return "";
  if (scan.runner_up->stop == CertifiedStop::kNothingAllowed) return "  elsewhere: no pose in the map\n";
  const Pose2 apart = between(scan.best->T_map_base, scan.runner_up->T_map_base);
  return fmt::format(
      "  elsewhere, {:.2f} m and {:.1f} deg away: mean distance {:.1f} mm, nowhere less than {:.1f} mm{}\n",
      apart.translation().norm(), std::fabs(deg_from_rad(apart.theta_rad)), 1000.0 * scan.runner_up->mean_cost_m,
      1000.0 * scan.runner_up->mean_bound_m, scan.is_ambiguous() ? "; it may be as good" : "");
}

std::string scan_text(const LocalizedScan& scan) {
  if (!scan.best) {
    const std::string why =
        scan.has_returns ? "the search was cut short" : fmt::format("too few returns, {}", scan.points);
    return fmt::format("scan {} at {:.6f} s: {}: {}\n", scan.index, scan.stamp_s, to_string(scan.verdict), why);
  }
  const Pose2& T = scan.best->T_map_base;
  return fmt::format("scan {} at {:.6f} s: {}: x {:.3f} m, y {:.3f} m, heading {:.2f} deg\n", scan.index, scan.stamp_s,
                     to_string(scan.verdict), T.x_m, T.y_m, deg_from_rad(T.theta_rad)) +
         fmt::format("  mean distance {:.1f} mm of {}; {}\n", 1000.0 * scan.best->mean_cost_m,
                     plural(scan.points, "point"), proof_text(*scan.best)) +
         runner_up_text(scan);
}

std::string fit_text(const FitLimit& fit) {
  const char* why = "as --poor-fit says";
  if (fit.source == FitLimit::Source::kRun) why = "99 of 100 scans of the run leave no more";
  if (fit.source == FitLimit::Source::kResolution) why = "two cells of the map";
  return fmt::format("a mean distance of more than {:.1f} mm is a poor fit: {}\n", 1000.0 * fit.distance_m, why);
}

std::uint64_t count_proven(const Localized& all) {
  return static_cast<std::uint64_t>(
      std::count_if(all.scans.begin(), all.scans.end(), [](const LocalizedScan& scan) { return scan.is_proven(); }));
}

std::uint64_t count_ambiguous(const TrackedDrive& drive) {
  return static_cast<std::uint64_t>(std::count_if(drive.scans.begin(), drive.scans.end(),
                                                  [](const TrackedScan& scan) { return scan.pose.is_ambiguous; }));
}

using Json = nlohmann::ordered_json;

Json found_json(const std::optional<CertifiedResult>& found) {
  if (!found || found->stop == CertifiedStop::kNothingAllowed) return nullptr;
  const Pose2& pose = found->T_map_base;
  return {{"x_m", pose.x_m},
          {"y_m", pose.y_m},
          {"theta_rad", pose.theta_rad},
          {"mean_distance_m", found->mean_cost_m},
          {"mean_bound_m", found->mean_bound_m},
          {"gap_m", found->gap_m},
          {"certified", found->certified()},
          {"stop", to_string(found->stop)},
          {"boxes", found->boxes},
          {"evaluations", found->evaluations}};
}

Json scan_json(const LocalizedScan& scan) {
  return {{"scan", scan.index},
          {"stamp_s", scan.stamp_s},
          {"points", scan.points},
          {"verdict", json_name(scan.verdict)},
          {"best", found_json(scan.best)},
          {"runner_up", found_json(scan.runner_up)},
          {"ambiguous", scan.runner_up || scan.is_elsewhere_open ? Json(scan.is_ambiguous()) : Json()}};
}

Json warnings_json(const std::vector<LogReader::Warning>& all) {
  Json warnings = Json::object();
  for (const LogReader::Warning& warning : all) warnings[warning.kind] = warning.count;
  return warnings;
}

Json times_json(const LocalizeTimes& times) {
  return {{"device", times.device}, {"wall_s", times.wall_s}, {"cpu_s", times.cpu_s}};
}

// First part of both reports: map, log, field and limit of a good fit.
Json begun_json(const LocalizeJob& job, const Localizer& localizer) {
  constexpr std::array kFitSources{"option", "run", "resolution"};    // in the order of FitLimit::Source
  constexpr std::array kFieldSources{"distances", "occupied-cells"};  // in the order of MapField::Source
  constexpr double kUnitsPerCell = 256.0;
  const MapField& field = localizer.field();
  const FitLimit& fit = localizer.good_fit();
  const double resolution_m = field.file.geometry.resolution_m;
  return {{"map", localizer.file()},
          {"log", job.log},
          {"field",
           {{"from", kFieldSources.at(static_cast<std::size_t>(field.source))},
            {"resolution_m", resolution_m},
            {"truncation_m", resolution_m * static_cast<double>(field.file.cap) / kUnitsPerCell}}},
          {"good_fit",
           {{"distance_m", fit.distance_m},
            {"usual_m", fit.usual_m},
            {"from", kFitSources.at(static_cast<std::size_t>(fit.source))}}}};
}

}  // namespace

std::string verdicts_text(const std::vector<LocalizedScan>& scans) {
  const auto counts = count_verdicts(scans);
  std::string text;
  for (const Verdict verdict : kVerdicts) {
    const std::uint64_t count = counts.at(static_cast<std::size_t>(verdict));
    if (verdict == Verdict::kNoPose && count == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, to_string(verdict));
  }
  return text;
}

std::string as_text(const Localizer& localizer, const Localized& all) {
  std::string text;
  for (const LocalizedScan& scan : all.scans) text += scan_text(scan);
  if (all.scans.size() > 1) {
    text += fmt::format("{}: {}; {} proven\n", plural(all.scans.size(), "scan"), verdicts_text(all.scans),
                        count_proven(all));
  }
  return text + fit_text(localizer.good_fit());
}

std::string as_text(const Localizer& localizer, const TrackedDrive& drive) {
  const auto counts = count_whereabouts(drive);
  std::string text;
  for (const Whereabouts whereabouts : kWhereabouts) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", counts.at(static_cast<std::size_t>(whereabouts)),
                        to_string(whereabouts));
  }
  return fmt::format("{}: {}; {} ambiguous; {} {} of the whole map\n", plural(drive.scans.size(), "scan"), text,
                     count_ambiguous(drive), drive.searches, drive.searches == 1 ? "search" : "searches") +
         fit_text(localizer.good_fit());
}

Json as_json(const LocalizeJob& job, const Localizer& localizer, const Localized& all, const LocalizeTimes& times) {
  const PoseWindow& window = localizer.window();
  const auto counts = count_verdicts(all.scans);
  Json verdicts = Json::object();
  for (const Verdict verdict : kVerdicts) {
    verdicts[json_name(verdict)] = counts.at(static_cast<std::size_t>(verdict));
  }
  Json json = begun_json(job, localizer);
  json["gap_m"] = localizer.limits().gap_m;
  json["window"] = {{"x_m", {window.centre.x_m - window.half_x_m, window.centre.x_m + window.half_x_m}},
                    {"y_m", {window.centre.y_m - window.half_y_m, window.centre.y_m + window.half_y_m}}};
  json["interrupted"] = all.interrupted;
  json["verdicts"] = verdicts;
  json["certified"] = count_proven(all);
  json["scans"] = Json::array();
  for (const LocalizedScan& scan : all.scans) json["scans"].push_back(scan_json(scan));
  json["warnings"] = warnings_json(all.warnings);
  json["times"] = times_json(times);
  json["times"]["scans_cpu_s"] = Json::array();
  for (const LocalizedScan& scan : all.scans) json["times"]["scans_cpu_s"].push_back(scan.cpu_s);
  return json;
}

Json as_json(const LocalizeJob& job, const Localizer& localizer, const TrackedDrive& drive,
             const LocalizeTimes& times) {
  const auto found = count_whereabouts(drive);
  Json counts = Json::object();
  for (const Whereabouts whereabouts : kWhereabouts) {
    counts[std::string(to_string(whereabouts))] = found.at(static_cast<std::size_t>(whereabouts));
  }
  Json json = begun_json(job, localizer);
  json["scans"] = drive.scans.size();
  json["interrupted"] = drive.interrupted;
  json["whereabouts"] = counts;
  json["ambiguous"] = count_ambiguous(drive);
  json["searches"] = drive.searches;
  json["warnings"] = warnings_json(drive.warnings);
  json["times"] = times_json(times);
  return json;
}

}  // namespace gdtslam
