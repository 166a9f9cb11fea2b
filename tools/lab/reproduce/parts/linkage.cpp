// Figure 11: the four-bar linkage in the three readings that turn all the way round.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "engine/drawing/linkage/linkage_drawing.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "gdtslam/core/angle.hpp"
#include "tools/lab/reproduce/part.hpp"

namespace gdtslam::reproduce {
namespace {

constexpr std::array<const char*, 3> kReadings{"paper-a", "paper-b", "paper-c"};

std::string both(const std::string& nominal, const std::string& calibrated) { return nominal + " / " + calibrated; }

std::vector<std::string> row_of(const std::string& preset) {
  const calib::LinkageCycle nominal(resolve_linkage(preset));
  const calib::LinkageCycle calibrated(resolve_linkage(preset + "-calibrated"));
  const calib::CrankRockerReport& n = nominal.report().value();
  const calib::CrankRockerReport& c = calibrated.report().value();
  const auto degrees = [](double a, double b) { return both(degrees_text(a), degrees_text(b)) + "\u00b0"; };
  const auto number = [](double a, double b) { return fmt::format("{:.2f} / {:.2f}", a, b); };
  const calib::FourBar& bars = nominal.model().bars;
  return {preset,
          fmt::format("{:.1f}, {:.1f}, {:.1f}, {:.1f} cm", 100.0 * bars.crank_m, 100.0 * bars.coupler_m,
                      100.0 * bars.rocker_m, 100.0 * bars.ground_m),
          degrees(n.swing_rad, c.swing_rad),
          degrees(nominal.begin().elevation_rad, calibrated.begin().elevation_rad),
          degrees(nominal.end().elevation_rad, calibrated.end().elevation_rad),
          number(n.time_ratio, c.time_ratio),
          degrees(n.least_transmission_rad, c.least_transmission_rad),
          number(n.most_rocker_rate, c.most_rocker_rate)};
}

Table readings_table() {
  Table table{"The readings with the paper\u2019s lengths, nominal / calibrated; elevations at the two dead points",
              {"reading", "crank, coupler, rocker, ground", "swing", "from", "to", "slow / quick stroke",
               "least transmission", "most rocker per crank"},
              {}};
  for (const char* preset : kReadings) table.rows.push_back(row_of(preset));
  return table;
}

// Shortest and longest bar against the other two.
std::string sums_text(const calib::FourBar& bars) {
  std::array<double, 4> lengths{bars.crank_m, bars.coupler_m, bars.rocker_m, bars.ground_m};
  std::sort(lengths.begin(), lengths.end());
  return fmt::format("{:.1f} < {:.1f} cm", 100.0 * (lengths[0] + lengths[3]), 100.0 * (lengths[1] + lengths[2]));
}

void add_rows(Part& part) {
  const calib::LinkageCycle b(resolve_linkage("paper-b"));
  const double swing_deg = deg_from_rad(b.report()->swing_rad);
  const double ratio = b.report()->time_ratio;
  const calib::FourBar& bars = b.model().bars;
  part.claim("a link turns all the way (Grashof)", "s + l < p + q", sums_text(bars),
             b.grashof() == calib::GrashofClass::kCrankRocker, "reading paper-b, nominal lengths");
  part.claim("swing of the laser", "0\u00b0 to 90\u00b0", fmt::format("{:.1f}\u00b0", swing_deg),
             swing_deg >= 85.0 && swing_deg <= 95.0,
             "rule: at most 5\u00b0 from the paper\u2019s 90\u00b0; reading paper-b");
  part.claim("lifts slowly, returns quickly", "yes", fmt::format("{:.2f} times as long up as down", ratio), ratio > 1.0,
             "reading paper-b");
  part.state("least transmission angle", "",
             fmt::format("{:.1f}\u00b0", deg_from_rad(b.report()->least_transmission_rad)),
             "below 30\u00b0 a joint transmits poorly: the paper\u2019s lengths are mechanically weak");
}

}  // namespace

Part make_linkages(const PartContext& place) {
  Part part;
  part.origin = Origin::kComputed;
  part.source = "From the lengths that the paper\u2019s appendix prints.";
  add_view(part, place, {.inputs = {"paper-b"}, .view = "scene", .size = "1600x900"},
           {"scene.png", "The mount as reading paper-b has it: four bars and the laser on the rocker."});
  double share = 0.25;
  for (const char* preset : kReadings) {
    add_picture(
        part, place, linkage_drawing(calib::LinkageCycle(resolve_linkage(preset))),
        {fmt::format("{}.svg", preset),
         fmt::format("Reading {}: positions over the lift with the dead points, elevation and transmission angle over "
                     "one turn of the crank.",
                     preset)});
    place.progress(share += 0.25);
    part.by_hand.push_back(fmt::format("gdtslam linkage {0} --picture {0}.svg", preset));
  }
  part.tables.push_back(readings_table());
  add_rows(part);
  part.notes.push_back(
      "Figure and appendix number the links differently: with the lengths of the appendix, (L3, L12, L5, L4) of the "
      "text is no crank-rocker, whatever L12 means. Three readings are; paper-b fits what is said of the motion best "
      "and is the default, though nothing establishes it.");
  part.by_hand.push_back("gdtslam render paper-b --view scene -o scene.png");
  return part;
}

}  // namespace gdtslam::reproduce
