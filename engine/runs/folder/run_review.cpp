#include "run_review.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

ClosedLoop reported_loop(const ReportReader& loop, std::uint64_t scans) {
  return {.from = loop.index("from", scans),
          .to = loop.index("to", scans),
          .T_from_to = {},
          .information = {},
          .weight = loop.number("weight"),
          .off_m = loop.number("off_m"),
          .off_rad = rad_from_deg(loop.number("off_deg")),
          .is_on = loop.truth("on")};
}

WheelReport reported_wheels(const ReportReader& wheels) {
  return {.distance = wheels.number("distance"),
          .turn = wheels.number("turn"),
          .turn_rad_per_m = rad_from_deg(wheels.number("turn_deg_per_m")),
          .sigma_distance = wheels.number("distance_sigma"),
          .sigma_turn = wheels.number("turn_sigma"),
          .sigma_rad_per_m = rad_from_deg(wheels.number("turn_deg_per_m_sigma")),
          .variance_factor = wheels.number("variance_factor"),
          .variance_factor_of_matches = wheels.number("variance_factor_of_matches")};
}

LoopFindings loop_findings(const ReportReader& report, std::uint64_t scans) {
  const ReportReader loops = report.section("loops");
  const ReportReader uncertain = report.section("uncertain");
  LoopFindings findings{.searches = loops.whole("searches"),
                        .rms_m = loops.number_or_null("rms_m"),
                        .loops = {},
                        .wheels = reported_wheels(report.section("wheels")),
                        .above_m = uncertain.number("above_m"),
                        .sigma_median_m = uncertain.number("sigma_median_m"),
                        .sigma_max_m = uncertain.number("sigma_max_m"),
                        .uncertain = {}};
  const std::vector<ReportReader> closures = loops.entries("closures");
  findings.loops.reserve(closures.size());
  for (const ReportReader& loop : closures) findings.loops.push_back(reported_loop(loop, scans));
  const std::vector<ReportReader> stretches = uncertain.entries("stretches");
  findings.uncertain.reserve(stretches.size());
  for (const ReportReader& stretch : stretches) {
    const std::size_t to = stretch.index("to", scans);
    findings.uncertain.push_back({stretch.index("from", to + 1), to, stretch.number("sigma_m")});
  }
  return findings;
}

}  // namespace

nlohmann::ordered_json findings_json(const std::vector<LogFinding>& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const LogFinding& finding : findings) {
    list.push_back({{"what", finding.what},
                    {"evidence", finding.evidence},
                    {"options", finding.options},
                    {"mended", finding.is_mended}});
  }
  return list;
}

std::vector<LogFinding> findings_from(const ReportReader& object) {
  std::vector<LogFinding> findings;
  if (!object.has("findings")) return findings;
  for (const ReportReader& entry : object.entries("findings")) {
    findings.push_back({entry.text("what"), entry.text("evidence"), entry.text("options"), entry.truth("mended")});
  }
  return findings;
}

RunDoubts read_doubts(const ReportReader& report, std::uint64_t scans) {
  const ReportReader matches = report.section("matches");
  RunDoubts doubts{.was_interrupted = report.truth("interrupted"),
                   .scans = scans,
                   .accepted = matches.whole("accepted"),
                   .weak = matches.whole("weak"),
                   .refused = matches.whole("refused"),
                   .restarts = report.whole("restarts"),
                   .findings = findings_from(report),
                   .loops = {}};
  if (report.has("loops")) doubts.loops = loop_findings(report, scans);
  return doubts;
}

namespace {

constexpr double kStandsOut = 3.0;  // standard deviations, as for the mapper's corrections
// Slope that gives 15 cm, from which on a pose is unreliable, over the 15 m of path in a local map.
constexpr double kWorthShare = 0.01;
constexpr double kWorthPull_rad_per_m = 2.0 * kUncertain_m / (15.0 * 15.0);
constexpr double kFarOff_m = 2.0 * kUncertain_m;  // offset of a loop that exceeds the errors of reliable poses
constexpr double kWorthFactor = 4.0;              // factor of a variance: twice the stated noise
// Loops cannot show how good matches are that are far better than stated. Their factor is then a tenth, and that of the
// wheels is larger in the same ratio and means nothing by itself.
constexpr double kKnownFactor = 0.1 * (1.0 + 1.0e-9);

// The pose of a stretch with the largest standard deviation.
std::size_t find_worst(const UncertainStretch& stretch, std::span<const PoseCovariance> covariances) {
  if (covariances.empty()) return stretch.from + (stretch.to - stretch.from) / 2;
  std::size_t worst = stretch.from;
  for (std::size_t i = stretch.from; i <= stretch.to; ++i) {
    if (covariances[i].sigma_m() > covariances[worst].sigma_m()) worst = i;
  }
  return worst;
}

std::string place_text(const Point2& at_m) { return fmt::format("({:.1f}, {:.1f}) m", at_m.x(), at_m.y()); }

ReviewNote no_loops_note(const RunDoubts& doubts) {
  if (doubts.was_interrupted) {
    return {"run", "the run was interrupted before its loops were closed: drift stayed in the map",
            "map the log to its end; loops are closed only then"};
  }
  return {"run", "loops were not closed: drift stayed in the map, and nothing tells where",
          "map the log without --no-loops"};
}

// A fault of the log causes most other doubts, so it comes first.
void add_findings(const std::vector<LogFinding>& findings, std::vector<ReviewNote>& notes) {
  for (const LogFinding& finding : findings) {
    if (finding.is_mended) continue;
    notes.push_back(
        {"log", fmt::format("{} ({})", finding.what, finding.evidence),
         finding.options.empty() ? "mend the log, and map it again" : "map the log again with " + finding.options});
  }
}

void add_run_notes(const RunDoubts& doubts, std::vector<ReviewNote>& notes) {
  if (!doubts.loops) {
    notes.push_back(no_loops_note(doubts));
  } else if (doubts.was_interrupted) {
    notes.push_back(
        {"run", "the run was interrupted while its scans were placed: the cloud is of the part of the log before that",
         "map the log again"});
  }
  if (doubts.loops && doubts.loops->loops.empty()) {
    notes.push_back(
        {"loops",
         fmt::format("no loop was found in {}: nothing ties the path to itself",
                     doubts.loops->searches == 1 ? "1 search" : fmt::format("{} searches", doubts.loops->searches)),
         "let the robot come back to places that it has seen, looking the same way"});
  }
  if (doubts.refused > 0) {
    notes.push_back(
        {"scans",
         fmt::format("{} of {} scans {} refused, {}: the pose is that of the odometry there", doubts.refused,
                     doubts.scans, doubts.refused == 1 ? "was" : "were", percent_text(doubts.refused, doubts.scans)),
         "find them in overview.png (rings) and report.json (doubtful_scans); map at the full scan rate"});
  }
  if (doubts.restarts > 0) {
    notes.push_back({"scans",
                     fmt::format("mapping went on {} where only odometry led",
                                 doubts.restarts == 1 ? "once" : fmt::format("{} times", doubts.restarts)),
                     "there the map may be bent or torn: drive slower, or where the laser sees something"});
  }
}

ReviewNote make_note(const UncertainStretch& stretch, const Trajectory& trajectory,
                     std::span<const PoseCovariance> covariances) {
  const bool is_first = stretch.from == 0;
  const bool is_last = stretch.to + 1 == trajectory.size();
  std::string advice = "drive there again, from a place that is sure and back to one";
  if (is_first) advice = "come back to where the drive began, before it ends";
  if (is_last) advice = "end the drive at a place that it has seen before";
  if (is_first && is_last) advice = "drive the way again in loops: places that are seen twice hold it";
  const Point2 at_m = trajectory[find_worst(stretch, covariances)].T_map_base.translation();
  return {"stretch",
          fmt::format("scans {} to {} ({:.1f} s to {:.1f} s), worst at {}: standard deviation up to {:.2g} m",
                      stretch.from, stretch.to, trajectory[stretch.from].stamp_s, trajectory[stretch.to].stamp_s,
                      place_text(at_m), stretch.sigma_m),
          std::move(advice), at_m};
}

ReviewNote make_note(const ClosedLoop& loop, const Trajectory& trajectory) {
  const Point2 from_m = trajectory[loop.from].T_map_base.translation();
  const Point2 to_m = trajectory[loop.to].T_map_base.translation();
  const char* const advice = loop.off_m < kFarOff_m
                                 ? "it is off by little: nothing to do where walls are single there"
                                 : "where walls are double there it was right; else two places look alike";
  return {"loop",
          fmt::format("loop from scan {} at {} to scan {} at {} is switched off: {:.2f} m and {:.1f} deg off",
                      loop.from, place_text(from_m), loop.to, place_text(to_m), loop.off_m, deg_from_rad(loop.off_rad)),
          advice, to_m};
}

void add_wheel_note(std::vector<ReviewNote>& notes, std::string finding, std::string advice) {
  notes.push_back({"wheels", std::move(finding), std::move(advice)});
}

void add_wheel_notes(const WheelReport& wheels, std::vector<ReviewNote>& notes) {
  const auto stands_out = [](double value, double sigma, double worth) {
    return std::fabs(value) > kStandsOut * sigma && std::fabs(value) > worth;
  };
  if (stands_out(wheels.distance, wheels.sigma_distance, kWorthShare)) {
    add_wheel_note(
        notes,
        fmt::format("distances by the wheels are {:.1f} % too {} (standard deviation {:.1f} %)",
                    100.0 * std::fabs(wheels.distance), wheels.distance > 0.0 ? "short" : "long",
                    100.0 * wheels.sigma_distance),
        fmt::format("the map is corrected for it; multiply the odometry's distances by {:.3f}", 1.0 + wheels.distance));
  }
  if (stands_out(wheels.turn, wheels.sigma_turn, kWorthShare)) {
    add_wheel_note(
        notes,
        fmt::format("turns by the wheels are {:.1f} % too {} (standard deviation {:.1f} %)",
                    100.0 * std::fabs(wheels.turn), wheels.turn > 0.0 ? "small" : "large", 100.0 * wheels.sigma_turn),
        fmt::format("the map is corrected for it; multiply the odometry's turns by {:.3f}", 1.0 + wheels.turn));
  }
  if (stands_out(wheels.turn_rad_per_m, wheels.sigma_rad_per_m, kWorthPull_rad_per_m)) {
    add_wheel_note(notes,
                   fmt::format("the wheels miss {:.2f} deg of turn in each metre (standard deviation {:.2f} deg)",
                               deg_from_rad(wheels.turn_rad_per_m), deg_from_rad(wheels.sigma_rad_per_m)),
                   "the map is corrected for it; one wheel is larger than the other: state both diameters");
  }
  if (wheels.variance_factor > kWorthFactor && wheels.variance_factor_of_matches > kKnownFactor) {
    add_wheel_note(notes,
                   fmt::format("the wheels slip: {:.1f} times as noisy as their steps tell, by what loops say",
                               std::sqrt(wheels.variance_factor)),
                   "look where the floor is smooth or the robot was pushed; turn more slowly");
  }
}

}  // namespace

std::string percent_text(std::uint64_t part, std::uint64_t whole) {
  const double percent = whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
  return part > 0 && percent < 1.0 ? fmt::format("{:.2g} %", percent) : fmt::format("{:.1f} %", percent);
}

std::vector<ReviewNote> review_notes(const RunDoubts& doubts, const Trajectory& trajectory,
                                     std::span<const PoseCovariance> covariances) {
  std::vector<ReviewNote> notes;
  add_findings(doubts.findings, notes);
  add_run_notes(doubts, notes);
  if (!doubts.loops) return notes;
  for (const UncertainStretch& stretch : doubts.loops->uncertain) {
    notes.push_back(make_note(stretch, trajectory, covariances));
  }
  for (const ClosedLoop& loop : doubts.loops->loops) {
    if (!loop.is_on) notes.push_back(make_note(loop, trajectory));
  }
  add_wheel_notes(doubts.loops->wheels, notes);
  return notes;
}

}  // namespace gdtslam
