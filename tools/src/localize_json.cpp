#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "localize_text.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

Json pose_json(const Pose2& pose) { return {{"x_m", pose.x_m}, {"y_m", pose.y_m}, {"theta_rad", pose.theta_rad}}; }

Json found_json(const std::optional<CertifiedResult>& found) {
  if (!found || found->stop == CertifiedStop::kNothingAllowed) return nullptr;
  Json json = pose_json(found->T_map_base);
  json.update({{"mean_distance_m", found->mean_cost_m},
               {"mean_bound_m", found->mean_bound_m},
               {"gap_m", found->gap_m},
               {"certified", found->certified()},
               {"stop", name_of(found->stop)},
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
  json["fault"] = fault == LocalizeFault::kNone ? Json() : Json(name_of(fault));
  json["known_share"] = reference.known_share;
  json["nearby"] = found_json(reference.nearby);
  return json;
}

Json scan_json(const LocalizedScan& scan, const LocalizeLimits& limits) {
  return {{"scan", scan.index},
          {"stamp_s", scan.stamp_s},
          {"points", scan.points},
          {"found", found_json(scan.best)},
          {"runner_up", found_json(scan.runner_up)},
          {"ambiguous", scan.runner_up ? Json(scan.is_ambiguous()) : Json()},
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

Json share_json(const Share& share) {
  const bool is_any = share.of > 0;
  return {{"count", share.count},
          {"of", share.of},
          {"share", is_any ? Json(share.value()) : Json()},
          {"low_95", is_any ? Json(share.low()) : Json()},
          {"high_95", is_any ? Json(share.high()) : Json()}};
}

Json error_json(const ErrorSummary& error) {
  const auto value = [&error](double number) { return error.count > 0 ? Json(number) : Json(); };
  return {
      {"count", error.count}, {"mean", value(error.mean)}, {"median", value(error.median)}, {"max", value(error.max)}};
}

Json errors_json(const LocalizeJob& job, const LocalizeLimits& limits, const LocalizeFigures& figures) {
  if (!job.reference) return nullptr;
  Json faults = Json::object();
  for (std::size_t k = 0; k < kLocalizeFaults.size(); ++k) {
    faults[std::string(name_of(kLocalizeFaults[k]))] = figures.faults[k];
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

Json json_of(const LocalizeJob& job, const Localizer& localizer, const Localized& all, const LocalizeTimes& times) {
  const LocalizeLimits& limits = localizer.limits();
  const LocalizeFigures figures = figures_of(all.scans, limits);
  Json scans = Json::array();
  for (const LocalizedScan& scan : all.scans) scans.push_back(scan_json(scan, limits));
  Json warnings = Json::object();
  for (const LogReader::Warning& warning : all.warnings) warnings[warning.kind] = warning.count;
  const PoseWindow& window = localizer.window();
  return {{"map", localizer.file()},
          {"log", job.log},
          {"gap_m", limits.gap_m},
          {"window",
           {{"x_m", {window.centre.x_m - window.half_x_m, window.centre.x_m + window.half_x_m}},
            {"y_m", {window.centre.y_m - window.half_y_m, window.centre.y_m + window.half_y_m}}}},
          {"choice", choice_json(job, all)},
          {"interrupted", all.interrupted},
          {"found", figures.found},
          {"certified", figures.certified},
          {"ambiguous", figures.ambiguous},
          {"errors", errors_json(job, limits, figures)},
          {"scans", scans},
          {"warnings", warnings},
          {"times", times_json(job, all, times)}};
}

}  // namespace gdtslam
