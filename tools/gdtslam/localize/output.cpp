#include "output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "output_parts.hpp"
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

std::string reference_text(const LocalizedScan& scan, const LocalizeLimits& limits) {
  if (!scan.reference) return "";
  const ReferencePose& reference = *scan.reference;
  const Pose2& T = reference.T_map_base;
  std::string text =
      fmt::format("  reference: x {:.3f} m, y {:.3f} m, heading {:.2f} deg", T.x_m, T.y_m, deg_from_rad(T.theta_rad));
  if (scan.best) {
    text += fmt::format("; {:.3f} m and {:.2f} deg off", reference.distance_m, deg_from_rad(reference.angle_rad));
  }
  const LocalizeFault fault = fault_of(scan, limits);
  if (fault == LocalizeFault::kNone || !scan.has_returns) return text + "\n";
  text += fmt::format(": {}\n", as_text(fault));
  if (!reference.nearby) return text;
  return text + fmt::format(
                    "  within {:g} cm and {:g} deg of it: mean distance {:.1f} mm, nowhere less than {:.1f} mm; "
                    "{:.0f} % of the points near an obstacle there\n",
                    100.0 * limits.within_m, deg_from_rad(limits.within_rad), 1000.0 * reference.nearby->mean_cost_m,
                    1000.0 * reference.nearby->mean_bound_m, 100.0 * reference.known_share);
}

std::string scan_text(const LocalizedScan& scan, const LocalizeLimits& limits) {
  if (!scan.best) {
    const std::string why =
        scan.has_returns ? "the search was cut short" : fmt::format("too few returns, {}", scan.points);
    return fmt::format("scan {} at {:.6f} s: {}: {}\n", scan.index, scan.stamp_s, to_string(scan.verdict), why) +
           reference_text(scan, limits);
  }
  const Pose2& T = scan.best->T_map_base;
  return fmt::format("scan {} at {:.6f} s: {}: x {:.3f} m, y {:.3f} m, heading {:.2f} deg\n", scan.index, scan.stamp_s,
                     to_string(scan.verdict), T.x_m, T.y_m, deg_from_rad(T.theta_rad)) +
         fmt::format("  mean distance {:.1f} mm of {}; {}\n", 1000.0 * scan.best->mean_cost_m,
                     plural(scan.points, "point"), proof_text(*scan.best)) +
         runner_up_text(scan) + reference_text(scan, limits);
}

std::string chosen_text(const LocalizeJob& job, const Localized& all, const LocalizeFigures& figures) {
  std::string text = plural(all.scans.size(), "scan");
  if (job.choice.random > 0) text += fmt::format(" at random of {}", all.candidates);
  if (job.merged) {
    text += fmt::format(", {} {} left out", all.left_out, near_text(*job.merged));
  }
  if (all.without_reference > 0) text += fmt::format(", {} without a reference", all.without_reference);
  return text + fmt::format(": {}; {} proven\n", as_text(figures.verdicts), figures.certified);
}

std::string within_text(const LocalizeLimits& limits, const LocalizeFigures& figures) {
  const Share& within = figures.within;
  std::string text = fmt::format(
      "within {:g} cm and {:g} deg of the reference: {} of {}, {:.1f} % (95 %: {:.1f} to "
      "{:.1f} %)\n",
      100.0 * limits.within_m, deg_from_rad(limits.within_rad), within.count, within.of, 100.0 * within.value(),
      100.0 * within.low(), 100.0 * within.high());
  if (within.count > 0) {
    text += fmt::format("  these: median {:.1f} cm and {:.2f} deg, mean {:.1f} cm and {:.2f} deg\n",
                        100.0 * figures.distance_m.median, figures.angle_deg.median, 100.0 * figures.distance_m.mean,
                        figures.angle_deg.mean);
  }
  for (std::size_t k = 0; k < kLocalizeFaults.size(); ++k) {
    if (figures.faults[k] > 0) text += fmt::format("  {}: {}\n", as_text(kLocalizeFaults[k]), figures.faults[k]);
  }
  return text;
}

using Json = nlohmann::ordered_json;

// "poor-fit"
std::string json_name(Verdict verdict) {
  std::string name(to_string(verdict));
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

Json pose_json(const Pose2& pose) { return {{"x_m", pose.x_m}, {"y_m", pose.y_m}, {"theta_rad", pose.theta_rad}}; }

Json found_json(const std::optional<CertifiedResult>& found) {
  if (!found || found->stop == CertifiedStop::kNothingAllowed) return nullptr;
  Json json = pose_json(found->T_map_base);
  json.update({{"mean_distance_m", found->mean_cost_m},
               {"mean_bound_m", found->mean_bound_m},
               {"gap_m", found->gap_m},
               {"certified", found->certified()},
               {"stop", to_string(found->stop)},
               {"boxes", found->boxes},
               {"evaluations", found->evaluations}});
  return json;
}

Json reference_json(const LocalizedScan& scan, const LocalizeLimits& limits) {
  if (!scan.reference) return nullptr;
  const ReferencePose& reference = *scan.reference;
  const LocalizeFault fault = fault_of(scan, limits);
  Json json = pose_json(reference.T_map_base);
  json["distance_m"] = scan.best ? Json(reference.distance_m) : Json();
  json["angle_rad"] = scan.best ? Json(reference.angle_rad) : Json();
  json["within"] = fault == LocalizeFault::kNone;
  json["fault"] = fault == LocalizeFault::kNone ? Json() : Json(to_string(fault));
  json["known_share"] = reference.known_share;
  json["nearby"] = found_json(reference.nearby);
  return json;
}

Json scan_json(const LocalizedScan& scan, const LocalizeLimits& limits) {
  return {{"scan", scan.index},
          {"stamp_s", scan.stamp_s},
          {"points", scan.points},
          {"verdict", json_name(scan.verdict)},
          {"best", found_json(scan.best)},
          {"runner_up", found_json(scan.runner_up)},
          {"ambiguous", scan.runner_up || scan.is_elsewhere_open ? Json(scan.is_ambiguous()) : Json()},
          {"reference", reference_json(scan, limits)}};
}

Json choice_json(const LocalizeJob& job, const Localized& all) {
  const ScanChoice& choice = job.choice;
  const bool is_random = choice.random > 0;
  return {{"first", is_random ? Json() : Json(choice.first)},
          {"every", choice.every > 0 ? Json(choice.every) : Json()},
          {"random", is_random ? Json(choice.random) : Json()},
          {"seed", is_random ? Json(choice.seed) : Json()},
          {"leave_out_s", job.merged ? Json(job.merged->within_s()) : Json()},
          {"candidates", all.candidates},
          {"left_out", all.left_out},
          {"without_reference", all.without_reference}};
}

Json errors_json(const LocalizeJob& job, const LocalizeLimits& limits, const LocalizeFigures& figures) {
  if (!job.reference) return nullptr;
  Json faults = Json::object();
  for (std::size_t k = 0; k < kLocalizeFaults.size(); ++k) {
    faults[std::string(to_string(kLocalizeFaults[k]))] = figures.faults[k];
  }
  return {{"reference", job.reference->file()},
          {"aligned", job.reference->is_aligned()},
          {"within_m", limits.within_m},
          {"within_deg", deg_from_rad(limits.within_rad)},
          {"within", share_json(figures.within)},
          {"distance_m", error_json(figures.distance_m)},
          {"angle_deg", error_json(figures.angle_deg)},
          {"faults", faults}};
}

Json times_json(const LocalizeJob& job, const Localized& all, const LocalizeTimes& times) {
  Json scans = Json::array();
  for (const LocalizedScan& scan : all.scans) scans.push_back(scan.cpu_s);
  return {{"device", times.device},
          {"threads", job.threads},
          {"wall_s", times.wall_s},
          {"cpu_s", times.cpu_s},
          {"scans_cpu_s", scans}};
}

}  // namespace

std::string as_text(const LocalizeJob& job, const Localizer& localizer, const Localized& all) {
  const LocalizeLimits& limits = localizer.limits();
  const LocalizeFigures figures = figures_of(all.scans, limits);
  const bool is_alone = job.choice.random == 0 && job.choice.every == 0;
  std::string text;
  for (const LocalizedScan& scan : all.scans) {
    const bool is_right = scan.reference && fault_of(scan, limits) == LocalizeFault::kNone;
    if (is_alone || !is_right) text += scan_text(scan, limits);
  }
  if (is_alone) return text + fit_text(localizer.good_fit());
  text += chosen_text(job, all, figures) + fit_text(localizer.good_fit());
  if (figures.within.of > 0) text += within_text(limits, figures);
  return text;
}

Json as_json(const LocalizeJob& job, const Localizer& localizer, const Localized& all, const LocalizeTimes& times) {
  const LocalizeLimits& limits = localizer.limits();
  const LocalizeFigures figures = figures_of(all.scans, limits);
  Json scans = Json::array();
  for (const LocalizedScan& scan : all.scans) scans.push_back(scan_json(scan, limits));
  Json warnings = Json::object();
  for (const LogReader::Warning& warning : all.warnings) warnings[warning.kind] = warning.count;
  Json verdicts = Json::object();
  for (const Verdict verdict : kVerdicts) {
    verdicts[json_name(verdict)] = figures.verdicts[static_cast<std::size_t>(verdict)];
  }
  const PoseWindow& window = localizer.window();
  return {{"map", localizer.file()},
          {"log", job.log},
          {"field", field_json(localizer.field())},
          {"gap_m", limits.gap_m},
          {"window",
           {{"x_m", {window.centre.x_m - window.half_x_m, window.centre.x_m + window.half_x_m}},
            {"y_m", {window.centre.y_m - window.half_y_m, window.centre.y_m + window.half_y_m}}}},
          {"choice", choice_json(job, all)},
          {"interrupted", all.interrupted},
          {"good_fit", fit_json(localizer.good_fit())},
          {"verdicts", verdicts},
          {"certified", figures.certified},
          {"errors", errors_json(job, limits, figures)},
          {"scans", scans},
          {"warnings", warnings},
          {"times", times_json(job, all, times)}};
}

}  // namespace gdtslam
