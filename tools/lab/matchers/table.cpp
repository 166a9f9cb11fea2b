#include "table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

std::string spread(const ErrorSummary& e, double factor, int digits) {
  return fmt::format("{:.{}f} ± {:.{}f}", factor * e.mean, digits, factor * e.deviation, digits);
}

// fmt counts bytes where a letter has two, so the widths are made here.
std::string padded(std::string text, std::size_t width) {
  const auto letters = static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
  return letters < width ? std::string(width - letters, ' ') + text : text;
}

std::string share_text(const Share& share) {
  return fmt::format("{:.1f} [{:.1f}, {:.1f}]", 100.0 * share.value(), 100.0 * share.low(), 100.0 * share.high());
}

std::string ratio_text(double ratio) { return ratio > 0.0 ? fmt::format("{:.2f}", ratio) : "-"; }

std::string name_column(std::string_view method) { return fmt::format("  {:<14}", method); }

std::string error_row(const MethodFigures& f) {
  constexpr double kCm = 100.0;
  const std::string name = name_column(f.method);
  if (f.distance_m.count == 0) return name + "  no scan\n";
  return name + padded(fmt::format("{:.2f}", kCm * f.distance_m.max), 8) + padded(spread(f.distance_m, kCm, 2), 15) +
         padded(fmt::format("{:.2f}", kCm * f.x_m.max), 8) + padded(spread(f.x_m, kCm, 2), 14) +
         padded(fmt::format("{:.2f}", kCm * f.y_m.max), 8) + padded(spread(f.y_m, kCm, 2), 14) +
         padded(fmt::format("{:.2f}", f.theta_deg.max), 8) + padded(spread(f.theta_deg, 1.0, 3), 16) + "\n";
}

std::string work_row(const MethodFigures& f) {
  const std::string name = name_column(f.method);
  if (f.distance_m.count == 0) return name + "  no scan\n";
  return name + padded(share_text(f.success), 21) + padded(share_text(f.optimal), 21) +
         padded(fmt::format("{:.1f}", f.evaluations.mean), 12) +
         padded(fmt::format("{:.0f}", f.evaluations.median), 9) +
         padded(fmt::format("{:.1f}", 1e6 * f.seconds.mean), 12) +
         padded(fmt::format("{:.1f}", 1e6 * f.seconds.median), 10) + padded(ratio_text(f.time_ratio), 10) + "\n";
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
  std::string text = "  " + padded("start", 14);
  for (const MatcherKind method : job.methods) text += padded(std::string(to_string(method)), 16);
  text += "\n";
  for (std::uint32_t level = 0; level <= job.levels.size(); ++level) {
    text += "  " + padded(level_text(job, level), 14);
    for (const MethodFigures& f : figures_of(job, outcome, level, ScanKind::kHeld)) {
      text += padded(fmt::format("{:.1f}", 100.0 * f.success.value()), 16);
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
    text += name_column(run.method) + padded(fmt::format("{:.2f}", 100.0 * run.position_m.max), 8) +
            padded(spread(run.position_m, 100.0, 2), 15) + padded(fmt::format("{:.3f}", run.heading_deg.max), 13) +
            padded(spread(run.heading_deg, 1.0, 3), 15) + padded(fmt::format("{:.2f}", run.cpu_s), 13) +
            padded(ratio_text(run.time_ratio), 11) + padded(fmt::format("{:.1f}", run.evaluations), 13) +
            padded(std::to_string(run.doubtful), 10) + "\n";
  }
  return text;
}

}  // namespace gdtslam
