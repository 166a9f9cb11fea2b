// Formats the findings in a log as text and as JSON.
#include "tools/gdtslam/doctor/doctor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "engine/runs/folder/run_review.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "engine/runs/warning_text.hpp"
#include "gdtslam/core/angle.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSlow_s = 10.0;
constexpr std::size_t kMostLayoutsShown = 4;

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string nod_text(const NodCheck& nod) {
  std::string text;
  if (nod.encoder_records > 0) {
    text += fmt::format("nodding          {} encoder records, ticks {} to {}\n", nod.encoder_records, nod.lowest_ticks,
                        nod.highest_ticks);
  }
  if (nod.tilt_records > 0) {
    text += fmt::format("tilting          {} tilt records, {:.2f} to {:.2f} deg\n", nod.tilt_records,
                        deg_from_rad(nod.lowest_tilt_rad), deg_from_rad(nod.highest_tilt_rad));
  }
  if (nod.has_records()) {
    text += fmt::format("                 {:.1f} Hz, longest gap {:.3f} s\n", nod.mean_rate_hz, nod.longest_gap_s);
  }
  return text;
}

std::string counts_text(const LogCheck& c) {
  const bool are_several = c.lasers.size() > 1;
  std::string text = fmt::format("scans            {}{} in {:.1f} s", c.scans,
                                 are_several ? fmt::format(" of {} lasers", c.lasers.size()) : "", c.duration_s());
  if (c.usual_step_s > kSlow_s) {
    text += fmt::format(", one in {:.3f} s (median)", c.usual_step_s);
  } else if (c.median_step_s > 0.0) {
    text += fmt::format(", {:.1f} Hz{} (median step {:.3f} s)", 1.0 / c.median_step_s, are_several ? " a laser" : "",
                        c.median_step_s);
  }
  if (c.scans_with_odometry + c.odometry_records == 0) return text + "\nodometry         none\n" + nod_text(c.nod);
  text +=
      fmt::format("\nodometry         {} scans with their own, {} records between; path {:.1f} m, turned {:.0f} deg\n",
                  c.scans_with_odometry, c.odometry_records, c.path_m, deg_from_rad(c.turned_rad));
  text += fmt::format("standing still   {} steps without any motion of the odometry\n", c.still_scans);
  return text + nod_text(c.nod);
}

// Lasers that turn unevenly vary their number of beams: the usual layouts are listed, the others only counted.
std::string layouts_text(const LogCheck& c, const LaserMount& laser) {
  std::vector<BeamLayout> layouts;
  std::copy_if(c.layouts.begin(), c.layouts.end(), std::back_inserter(layouts),
               [&laser](const BeamLayout& layout) { return layout.laser == laser.laser; });
  std::stable_sort(layouts.begin(), layouts.end(),
                   [](const BeamLayout& a, const BeamLayout& b) { return a.scans > b.scans; });
  std::string text;
  std::uint64_t others = laser.scans;
  for (std::size_t k = 0; k < std::min(layouts.size(), kMostLayoutsShown); ++k) {
    const BeamLayout& b = layouts[k];
    others -= b.scans;
    const double step_deg = deg_from_rad(b.step_rad);
    const double sweep_deg = b.beams > 0 ? static_cast<double>(b.beams - 1) * step_deg : 0.0;
    double first_deg = deg_from_rad(b.first_bearing_rad);  // a laser that turns clockwise may begin a turn earlier
    if (std::min(first_deg, first_deg + sweep_deg) < -360.0) first_deg += 360.0;
    const double last_deg = first_deg + sweep_deg;
    text += fmt::format("beams            {} from {:.2f} to {:.2f} deg, step {:.3f} deg, in {}", b.beams, first_deg,
                        last_deg, step_deg, plural(b.scans, "scan"));
    text += b.max_range_m > 0.0 ? fmt::format("; stated limit {:.2f} m\n", b.max_range_m) : "\n";
  }
  if (others > 0) text += "beams            others in " + plural(others, "scan") + "\n";
  return text;
}

// With several lasers each line has the laser's number and scans.
std::string laser_text(const LogCheck& c, const LaserMount& laser) {
  std::string text;
  if (c.lasers.size() > 1) text += fmt::format("laser {:<10} {}\n", laser.laser, plural(laser.scans, "scan"));
  text += layouts_text(c, laser);
  text += fmt::format("laser on robot   {:.3f} m ahead, {:.3f} m left, {:.2f} deg", laser.T_base_laser.x_m,
                      laser.T_base_laser.y_m, deg_from_rad(laser.T_base_laser.theta_rad));
  return text + (laser.changes > 0 ? "; differs in " + plural(laser.changes, "scan") + "\n" : "\n");
}

std::string sensor_text(const LogCheck& c) {
  std::string text;
  for (const LaserMount& laser : c.lasers) text += laser_text(c, laser);
  const RangeStatistics& r = c.ranges;
  text += fmt::format("ranges           {:.2f} to {:.2f} m, median {:.2f} m, {:.1f} % of {} beams\n", r.shortest_m,
                      r.longest_m, r.median_m, 100.0 * share(r.returns, r.beams), r.beams);
  text += "no return        ";
  for (const double value_m : r.no_return_m) text += fmt::format("{:.2f} m, ", value_m);
  text += fmt::format("{:.1f} % of the beams; nothing at all: {:.1f} %\n", 100.0 * share(r.no_return_count, r.beams),
                      100.0 * share(r.not_finite, r.beams));
  return text;
}

std::string events_text(const std::string& name, const EventList& events, const std::string& bound,
                        const std::function<std::string(const LogEvent&)>& describe) {
  if (events.count == 0) return fmt::format("{:<16} none{}\n", name, bound);
  std::string text = fmt::format("{:<16} {}{}\n", name, events.count, bound);
  for (std::size_t k = 0; k < events.first.size(); ++k) {
    const LogEvent& event = events.first[k];
    text += fmt::format("                 scan {} at {:.6f} s: {}\n", event.scan, event.stamp_s, describe(event));
  }
  if (events.count > EventList::kMostListed)
    text += fmt::format("                 and {} more\n", events.count - EventList::kMostListed);
  return text;
}

std::string faults_text(const LogCheck& c, const StepBounds& bounds) {
  const auto step = [](const LogEvent& e) { return fmt::format("{:+.6f} s", e.time_step_s); };
  std::string text = events_text("gaps", c.gaps, fmt::format(" (longer than {:.2f} s)", c.gap_bound_s), step);
  text += events_text("backward stamps", c.backward_stamps, "", step);
  text += events_text("repeated stamps", c.repeated_stamps, "", step);
  text +=
      events_text("odometry jumps", c.impossible_steps,
                  fmt::format(" (more than {:g} m + {:g} m/s or {:.0f} deg + {:.0f} deg/s)", bounds.distance_m,
                              bounds.speed_m_s, deg_from_rad(bounds.angle_rad), deg_from_rad(bounds.turn_rate_rad_s)),
                  [](const LogEvent& e) {
                    return fmt::format("{:.3f} m and {:.1f} deg in {:.3f} s", e.distance_m, deg_from_rad(e.angle_rad),
                                       e.time_step_s);
                  });
  if (c.scans_without_returns > 0)
    text += fmt::format("empty scans      {} without any return\n", c.scans_without_returns);
  if (c.mappable_scans < c.scans) {
    text += fmt::format("unused scans     {} with fewer than {} returns (scan.min_points)\n",
                        c.scans - c.mappable_scans, c.scan.min_points);
  }
  for (const LogReader::Warning& w : c.warnings) {
    if (w.kind == "laser mount unknown") continue;  // printed with the topics
    text += fmt::format("{:<16} {}, first: {}\n", w.kind, w.count, w.first);
  }
  return text;
}

std::string delay_text(const std::optional<OdometryDelay>& delay) {
  if (!delay) return "";
  return fmt::format("odometry stamps  {:.3f} s {} than the scans, +-{:.3f} s{}\n", std::fabs(delay->delay_s),
                     delay->delay_s < 0.0 ? "earlier" : "later", delay->sigma_s,
                     delay->stands_out()       ? ": map makes up for it"
                     : delay->is_long_enough() ? "; too uncertain to make up for"
                                               : "; too little to matter");
}

std::string advice_text(const Findings& found) {
  std::string text;
  for (const LogFinding& fault : found.faults) text += "-> " + finding_text(fault) + "\n";
  for (const std::string& suggestion : found.check.suggestions()) text += "-> " + suggestion + "\n";
  const std::vector<LaserContents>& lasers = found.contents.lasers;
  const bool is_placed = std::none_of(lasers.begin(), lasers.end(),
                                      [](const LaserContents& laser) { return laser.mount == MountSource::kUnknown; });
  if (!is_placed) {
    text +=
        "-> the recording does not tell where the laser sits: if not in the robot's centre, add --mount x,y,yaw, "
        "for example --mount 0.2m,0,0 where it sits 20 cm ahead\n";
  }
  const std::string obstacle = found.check.obstacle();
  if (!obstacle.empty()) return text + "It cannot be mapped: " + obstacle + ".\n";
  text += found.commands.front().when.empty() ? "It can be mapped:\n" : "It can be mapped\n";
  for (const MapCommand& command : found.commands) {
    if (!command.when.empty()) text += "- " + command.when + ":\n";
    text += "  " + command.line + "\n";
  }
  return text;
}

Json as_json(const EventList& events) { return {{"count", events.count}, {"largest", events.largest}}; }

Json ranges_json(const RangeStatistics& r) {
  return {{"beams", r.beams},
          {"returns", r.returns},
          {"not_finite", r.not_finite},
          {"no_return", r.no_return_count},
          {"no_return_values_m", r.no_return_m},
          {"shortest_m", r.shortest_m},
          {"median_m", r.median_m},
          {"longest_m", r.longest_m}};
}

Json mounts_json(const std::vector<LaserMount>& lasers) {
  Json list = Json::array();
  for (const LaserMount& mount : lasers) {
    const Pose2& T = mount.T_base_laser;
    list.push_back({{"laser", mount.laser},
                    {"scans", mount.scans},
                    {"x_m", T.x_m},
                    {"y_m", T.y_m},
                    {"theta_rad", T.theta_rad},
                    {"changes", mount.changes}});
  }
  return list;
}

}  // namespace

std::string findings_text(const Findings& found, const std::string& log) {
  return fmt::format("log              {}, {}\n", log_name(log), found.contents.format) +
         contents_text(found.contents, found.check) + counts_text(found.check) + sensor_text(found.check) +
         faults_text(found.check, found.bounds) + delay_text(found.delay) + advice_text(found);
}

Json findings_json(const Findings& found, const std::string& log) {
  const LogCheck& c = found.check;
  const std::optional<OdometryDelay>& delay = found.delay;
  Json report{{"log", log}, {"mappable", c.obstacle().empty()}, {"obstacle", c.obstacle()}};
  add_contents(found.contents, report);
  report["scans"] = c.scans;
  report["mappable_scans"] = c.mappable_scans;
  report["duration_s"] = c.duration_s();
  report["median_step_s"] = c.usual_step_s;
  report["scans_with_odometry"] = c.scans_with_odometry;
  report["odometry_records"] = c.odometry_records;
  report["encoder_records"] = c.nod.encoder_records;
  report["tilt_records"] = c.nod.tilt_records;
  report["path_m"] = c.path_m;
  report["turned_rad"] = c.turned_rad;
  report["still_steps"] = c.still_scans;
  report["gaps"] = as_json(c.gaps);
  report["backward_stamps"] = as_json(c.backward_stamps);
  report["repeated_stamps"] = as_json(c.repeated_stamps);
  report["impossible_steps"] = as_json(c.impossible_steps);
  if (delay) {
    report["odometry_delay"] = {
        {"delay_s", delay->delay_s}, {"sigma_s", delay->sigma_s}, {"stands_out", delay->stands_out()}};
  }
  report["lasers_on_robot"] = mounts_json(c.lasers);
  report["ranges"] = ranges_json(c.ranges);
  report["scans_without_returns"] = c.scans_without_returns;
  Json warnings = Json::object();
  for (const LogReader::Warning& w : c.warnings) warnings[w.kind] = {{"count", w.count}, {"first", w.first}};
  report["warnings"] = warnings;
  report["findings"] = findings_json(found.faults);
  report["suggestions"] = c.suggestions();
  Json commands = Json::array();
  for (const MapCommand& command : found.commands) {
    commands.push_back({{"when", command.when}, {"line", command.line}});
  }
  report["commands"] = commands;
  return report;
}

}  // namespace gdtslam
