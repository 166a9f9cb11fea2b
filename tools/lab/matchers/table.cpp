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
  return name_column(f.method) + fmt::format("{:>8.2f}{:>15}{:>8.2f}{:>14}{:>8.2f}{:>14}{:>8.2f}{:>16}\n",
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

std::string table_of(const std::vector<MethodFigures>& figures) {
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

std::string basin_of(const CompareJob& job, const CompareOutcome& outcome) {
  std::string text = fmt::format("  {:>14}", "start");
  for (const MatcherKind method : job.methods) text += fmt::format("{:>16}", to_string(method));
  text += "\n";
  for (std::uint32_t level = 0; level <= job.levels.size(); ++level) {
    text += fmt::format("  {:>14}", level_text(job, level));
    for (const MethodFigures& f : figures_of(job, outcome, level, ScanKind::kHeld)) {
      text += fmt::format("{:>16.1f}", 100.0 * f.success.value());
    }
    text += "\n";
  }
  return text;
}

}  // namespace

std::string level_text(const CompareJob& job, std::uint32_t level) {
  if (level == 0) return "prediction";
  const StartLevel& off = job.levels[level - 1];
  return fmt::format("{:g} cm, {:g}°", 100.0 * off.distance_m, deg_from_rad(off.angle_rad));
}

std::string as_text(const CompareJob& job, const CompareOutcome& outcome) {
  const std::uint64_t held = count_of(outcome, ScanKind::kHeld);
  const std::uint64_t weak = count_of(outcome, ScanKind::kWeak);
  const std::uint64_t uncertain = count_of(outcome, ScanKind::kUncertain);
  std::string text = fmt::format(
      "{} scans, one in {} measured: {} count below, {} are weak along a corridor, {} have no proof within {:g} mm;\n"
      "{} were not matched, {} lie beyond the map\n\n",
      outcome.scans_read, outcome.every, held, weak, uncertain, 1000.0 * job.global.gap_m, outcome.refused,
      outcome.too_few);
  text += "Table 1: errors against the proven global solution, started where the odometry says\n\n" +
          table_of(figures_of(job, outcome, 0, ScanKind::kHeld));
  if (weak > 0) {
    text += "\nThe same for the scans that are weak along a corridor\n\n" +
            table_of(figures_of(job, outcome, 0, ScanKind::kWeak));
  }
  text += fmt::format("\nSuccess, % within {:g} cm and {:g}°, by the start's distance from the solution\n\n",
                      100.0 * kSuccess_m, kSuccess_deg) +
          basin_of(job, outcome);
  return text;
}

std::string as_text(const std::vector<WholeRun>& runs, const CompareTruth& truth) {
  if (runs.empty()) return {};
  std::string text = fmt::format(
      "\nTable 2: whole runs against {}\n\n"
      "                  position, cm                heading, deg            CPU time, s  / simplex  evaluations  "
      "doubtful\n"
      "                     max     mean ± std          max     mean ± std                              a scan\n",
      truth.reference ? "the reference (ATE)" : "the verified relations");
  for (const WholeRun& run : runs) {
    text += name_column(run.method) + fmt::format("{:>8.2f}{:>15}{:>13.3f}{:>15}{:>13.2f}{:>11}{:>13.1f}{:>10}\n",
                                                  100.0 * run.position_m.max, spread(run.position_m, 100.0, 2),
                                                  run.heading_deg.max, spread(run.heading_deg, 1.0, 3), run.cpu_s,
                                                  ratio_text(run.time_ratio), run.evaluations, run.doubtful);
  }
  return text;
}

}  // namespace gdtslam
