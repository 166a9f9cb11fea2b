#include "run_doubts.hpp"

#include <cstddef>

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

RunDoubts doubts_of(const ReportReader& report, std::uint64_t scans) {
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

}  // namespace gdtslam
