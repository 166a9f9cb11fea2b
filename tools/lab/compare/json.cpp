#include <fmt/format.h>

#include "gdtslam/core/angle.hpp"
#include "tools/lab/matchers/output.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const ErrorSummary& e) {
  const auto value = [&e](double number) { return e.count > 0 ? Json(number) : Json(); };
  return {{"count", e.count},          {"mean", value(e.mean)}, {"std", value(e.deviation)},
          {"median", value(e.median)}, {"rmse", value(e.rmse)}, {"max", value(e.max)}};
}

Json as_json(const Share& share) {
  if (share.of == 0) return {{"count", 0}, {"of", 0}, {"share", nullptr}, {"low_95", nullptr}, {"high_95", nullptr}};
  return {{"count", share.count},
          {"of", share.of},
          {"share", share.value()},
          {"low_95", share.low()},
          {"high_95", share.high()}};
}

Json as_json(const std::vector<MethodFigures>& figures) {
  Json methods = Json::array();
  for (const MethodFigures& f : figures) {
    methods.push_back({{"method", f.method},
                       {"distance_m", as_json(f.distance_m)},
                       {"x_m", as_json(f.x_m)},
                       {"y_m", as_json(f.y_m)},
                       {"theta_deg", as_json(f.theta_deg)},
                       {"success", as_json(f.success)},
                       {"optimal", as_json(f.optimal)},
                       {"evaluations", as_json(f.evaluations)}});
  }
  return methods;
}

Json scans_json(const CompareJob& job, const CompareOutcome& outcome) {
  return {{"read", outcome.scans_read},
          {"every", outcome.every},
          {"measured", outcome.scans.size()},
          {"counted", count_of(outcome, ScanKind::kHeld)},
          {"weak", count_of(outcome, ScanKind::kWeak)},
          {"not_certified", count_of(outcome, ScanKind::kUncertain)},
          {"not_matched", outcome.refused},
          {"too_few_points", outcome.too_few},
          {"gap_m", job.global.gap_m},
          {"weak_below", kWeakHold}};
}

Json level_json(const CompareJob& job, const CompareOutcome& outcome, std::uint32_t level) {
  const StartLevel off = level > 0 ? job.levels[level - 1] : StartLevel{};
  Json json{{"start", level > 0 ? "solution" : "prediction"}};
  if (level > 0) {
    json["distance_m"] = off.distance_m;
    json["angle_deg"] = deg_from_rad(off.angle_rad);
  }
  json["held"] = as_json(figures_of(job, outcome, level, ScanKind::kHeld));
  json["weak"] = as_json(figures_of(job, outcome, level, ScanKind::kWeak));
  return json;
}

Json times_json(const CompareJob& job, const CompareOutcome& outcome) {
  std::vector<double> seconds;
  for (const CompareScan& scan : outcome.scans) seconds.push_back(scan.seconds);
  Json levels = Json::array();
  for (std::uint32_t level = 0; level <= job.levels.size(); ++level) {
    Json methods = Json::array();
    for (const MethodFigures& f : figures_of(job, outcome, level, ScanKind::kHeld)) {
      methods.push_back({{"method", f.method},
                         {"seconds", as_json(f.seconds)},
                         {"over_simplex", f.time_ratio > 0.0 ? Json(f.time_ratio) : Json()}});
    }
    levels.push_back(std::move(methods));
  }
  return {{"global_solution_s", as_json(summarise(seconds))}, {"levels", std::move(levels)}};
}

Json as_json(const std::vector<WholeRun>& runs) {
  Json rows = Json::array();
  for (const WholeRun& run : runs) {
    rows.push_back({{"method", run.method},
                    {"position_m", as_json(run.position_m)},
                    {"heading_deg", as_json(run.heading_deg)},
                    {"scans", run.scans},
                    {"doubtful", run.doubtful},
                    {"evaluations_per_scan", run.evaluations}});
  }
  return rows;
}

}  // namespace

Json as_json(const CompareJob& job, const CompareOutcome& outcome, const std::vector<WholeRun>& runs,
             const CompareTruth& truth) {
  Json levels = Json::array();
  for (std::uint32_t level = 0; level <= job.levels.size(); ++level) {
    levels.push_back(level_json(job, outcome, level));
  }
  Json json{{"version", 1},
            {"seed", job.seed},
            {"scans", scans_json(job, outcome)},
            {"success_within", {{"distance_m", kSuccess_m}, {"angle_deg", kSuccess_deg}}},
            {"levels", std::move(levels)}};
  Json times = times_json(job, outcome);
  if (!runs.empty()) {
    json["whole_runs"] = {{"metric", truth.reference ? "ate" : "relations"}, {"methods", as_json(runs)}};
    Json whole = Json::array();
    for (const WholeRun& run : runs) {
      whole.push_back({{"method", run.method},
                       {"cpu_s", run.cpu_s},
                       {"over_simplex", run.time_ratio > 0.0 ? Json(run.time_ratio) : Json()}});
    }
    times["whole_runs"] = std::move(whole);
  }
  json["times"] = std::move(times);
  return json;
}

std::string as_csv(const CompareJob& job, const CompareOutcome& outcome) {
  std::string text =
      "scan,stamp_s,points,hold,certified,solution_x_m,solution_y_m,solution_theta_rad,solution_cost_m,bound_m,level,"
      "start,start_m,start_deg,method,distance_m,x_m,y_m,theta_deg,excess_m,success,optimal,evaluations,time_us\n";
  for (const CompareTrial& t : outcome.trials) {
    const CompareScan& s = outcome.scans[t.scan];
    text += fmt::format("{},{:.6f},{},{:.6f},{},{:.6f},{:.6f},{:.7f},{:.7f},{:.7f},", s.index, s.stamp_s, s.points,
                        s.hold, s.is_certified ? 1 : 0, s.T_map_base.x_m, s.T_map_base.y_m, s.T_map_base.theta_rad,
                        s.mean_cost_m, s.mean_bound_m);
    text += fmt::format("{},{},{:.6f},{:.5f},{},{:.6f},{:.6f},{:.6f},{:.5f},{:.7f},{},{},{},{:.2f}\n", t.level, t.start,
                        t.start_m, deg_from_rad(t.start_rad), to_string(job.methods[t.method]), t.distance_m, t.x_m,
                        t.y_m, deg_from_rad(t.theta_rad), t.excess_m, t.is_success() ? 1 : 0, t.is_optimal ? 1 : 0,
                        t.evaluations, 1e6 * t.seconds);
  }
  return text;
}

}  // namespace gdtslam
