#include <fmt/format.h>

#include "gdtslam/core/angle.hpp"
#include "output.hpp"

namespace gdtslam {
namespace {

std::string spread(const ErrorSummary& e, double factor, int digits) {
  return fmt::format("{:.{}f} ± {:.{}f}", factor * e.mean, digits, factor * e.deviation, digits);
}

std::string share_text(const Share& share) {
  return fmt::format("{:.1f} [{:.1f}, {:.1f}]", 100.0 * share.value(), 100.0 * share.low(), 100.0 * share.high());
}

std::string ratio_text(double ratio) { return ratio > 0.0 ? fmt::format("{:.2f}", ratio) : "-"; }

std::string name_column(std::string_view method) { return fmt::format("  {:<14}", method); }

std::string error_row(const MethodFigures& f) {
  constexpr double kCm = 100.0;
  if (f.distance_m.count == 0) return name_column(f.method) + "  no scan\n";
  return name_column(f.method) + fmt::format(" {:>7.2f} {:>14} {:>7.2f} {:>13} {:>7.2f} {:>13} {:>7.2f} {:>15}\n",
                                             kCm * f.distance_m.max, spread(f.distance_m, kCm, 2), kCm * f.x_m.max,
                                             spread(f.x_m, kCm, 2), kCm * f.y_m.max, spread(f.y_m, kCm, 2),
                                             f.theta_deg.max, spread(f.theta_deg, 1.0, 3));
}

std::string work_row(const MethodFigures& f) {
  if (f.distance_m.count == 0) return name_column(f.method) + "  no scan\n";
  return name_column(f.method) + fmt::format("{:>21}{:>21}{:>12.1f}{:>9.0f}{:>12.1f}{:>10.1f}{:>10}\n",
                                             share_text(f.success), share_text(f.optimal), f.evaluations.mean,
                                             f.evaluations.median, 1e6 * f.seconds.mean, 1e6 * f.seconds.median,
                                             ratio_text(f.time_ratio));
}

std::string error_table(const std::vector<MethodFigures>& figures) {
  std::string text =
      "                  distance, cm                 |x|, cm               |y|, cm               |theta|, deg\n"
      "                     max     mean ± std     max    mean ± std     max    mean ± std     max      mean ± std\n";
  for (const MethodFigures& f : figures) text += error_row(f);
  text +=
      "\n"
      "                          success, %     proven optimal, %  evaluations               time, us         "
      "  / simplex\n"
      "                          [95 %]               [95 %]           mean   median        mean    median\n";
  for (const MethodFigures& f : figures) text += work_row(f);
  return text;
}

std::string basin_table(const CompareJob& job, const CompareOutcome& outcome) {
  std::string text = fmt::format("  {:>14}", "start");
  for (const MatcherKind method : job.methods) text += fmt::format("{:>16}", to_string(method));
  text += "\n";
  for (std::uint32_t level = 0; level <= job.levels.size(); ++level) {
    text += fmt::format("  {:>14}", level_text(job, level));
    for (const MethodFigures& f : sum_figures(job, outcome, level, ScanKind::kHeld)) {
      text += fmt::format("{:>16}", f.success.of > 0 ? fmt::format("{:.1f}", 100.0 * f.success.value()) : "-");
    }
    text += "\n";
  }
  return text;
}

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
          {"counted", count_kind(outcome, ScanKind::kHeld)},
          {"weak", count_kind(outcome, ScanKind::kWeak)},
          {"not_certified", count_kind(outcome, ScanKind::kUncertain)},
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
  json["held"] = as_json(sum_figures(job, outcome, level, ScanKind::kHeld));
  json["weak"] = as_json(sum_figures(job, outcome, level, ScanKind::kWeak));
  return json;
}

Json times_json(const CompareJob& job, const CompareOutcome& outcome) {
  std::vector<double> seconds;
  for (const CompareScan& scan : outcome.scans) seconds.push_back(scan.seconds);
  Json levels = Json::array();
  for (std::uint32_t level = 0; level <= job.levels.size(); ++level) {
    Json methods = Json::array();
    for (const MethodFigures& f : sum_figures(job, outcome, level, ScanKind::kHeld)) {
      methods.push_back({{"method", f.method},
                         {"seconds", as_json(f.seconds)},
                         {"over_simplex", f.time_ratio > 0.0 ? Json(f.time_ratio) : Json()}});
    }
    levels.push_back(std::move(methods));
  }
  return {{"global_solution_s", as_json(summarise(seconds))}, {"levels", std::move(levels)}};
}

}  // namespace

std::string level_text(const CompareJob& job, std::uint32_t level) {
  if (level == 0) return "prediction";
  const StartLevel& off = job.levels[level - 1];
  return fmt::format("{:g} cm, {:g}°", 100.0 * off.distance_m, deg_from_rad(off.angle_rad));
}

std::string as_text(const CompareJob& job, const CompareOutcome& outcome) {
  const std::uint64_t held = count_kind(outcome, ScanKind::kHeld);
  const std::uint64_t weak = count_kind(outcome, ScanKind::kWeak);
  const std::uint64_t uncertain = count_kind(outcome, ScanKind::kUncertain);
  std::string text = fmt::format(
      "{} scans, one in {} measured: {} count below, {} are weak along a corridor, {} have no proof within {:g} mm;\n"
      "{} were not matched, {} lie beyond the map\n\n",
      outcome.scans_read, outcome.every, held, weak, uncertain, 1000.0 * job.global.gap_m, outcome.refused,
      outcome.too_few);
  text += "Table 1: errors against the proven global solution, started where the odometry says\n\n" +
          error_table(sum_figures(job, outcome, 0, ScanKind::kHeld));
  if (weak > 0) {
    text += "\nThe same for the scans that are weak along a corridor\n\n" +
            error_table(sum_figures(job, outcome, 0, ScanKind::kWeak));
  }
  text += fmt::format("\nSuccess, % within {:g} cm and {:g}°, by the start's distance from the solution\n\n",
                      100.0 * kSuccess_m, kSuccess_deg) +
          basin_table(job, outcome);
  return text;
}

Json as_json(const CompareJob& job, const CompareOutcome& outcome) {
  Json levels = Json::array();
  for (std::uint32_t level = 0; level <= job.levels.size(); ++level) {
    levels.push_back(level_json(job, outcome, level));
  }
  return {{"version", 1},
          {"seed", job.seed},
          {"scans", scans_json(job, outcome)},
          {"success_within", {{"distance_m", kSuccess_m}, {"angle_deg", kSuccess_deg}}},
          {"levels", std::move(levels)},
          {"times", times_json(job, outcome)}};
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
