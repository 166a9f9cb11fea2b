// The summary of a linkage for people and for programs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gdtslam/core/angle.hpp"
#include "linkage_table.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;
using calib::FourBar;

constexpr int kScanSteps = 1440;

/// The extremes over the summary's span.
struct Extremes {
  double most_acceleration = 0.0;
  calib::RockerSensitivity most;
};

Extremes extremes_of(const LinkageSummary& summary) {
  Extremes extremes;
  for (const LinkageRow& row : rows_of(summary, kScanSteps)) {
    if (!row.motion || !row.sensitivity) {
      continue;
    }
    const auto raise = [](double& most, double value) { most = std::max(most, std::fabs(value)); };
    raise(extremes.most_acceleration, row.motion->rocker_acceleration);
    raise(extremes.most.crank, row.sensitivity->crank);
    raise(extremes.most.coupler, row.sensitivity->coupler);
    raise(extremes.most.rocker, row.sensitivity->rocker);
    raise(extremes.most.ground, row.sensitivity->ground);
  }
  return extremes;
}

double deg_per_mm(double rad_per_m) { return deg_from_rad(rad_per_m) / 1000.0; }
double positive_deg(double angle_rad) {
  const double turns = angle_rad / kTwoPi;
  return 360.0 * (turns - std::floor(turns));
}

std::string line(const char* name, const std::string& text) { return fmt::format("{:<14} {}\n", name, text); }

std::string cm(double length_m) { return fmt::format("{:.6g}", 100.0 * length_m); }

std::string bars_text(const LinkageSummary& summary) {
  const FourBar& bars = summary.model.bars;
  return fmt::format("crank {}, coupler {}, rocker {}, ground {} cm; {} assembly", cm(bars.crank_m), cm(bars.coupler_m),
                     cm(bars.rocker_m), cm(bars.ground_m),
                     summary.model.assembly == calib::Assembly::kOpen ? "open" : "crossed");
}

std::string end_text(const LinkageEnd& end) {
  return fmt::format("crank {:5.1f} deg: rocker {:>6} deg, elevation {:>5} deg", positive_deg(end.crank_rad),
                     degrees_text(end.rocker_rad), degrees_text(end.elevation_rad));
}

std::string lift_text(const LinkageSummary& summary, const calib::CrankRockerReport& report) {
  return fmt::format("{:.1f} of 360 deg, the crank turning {} in the linkage's frame; time ratio {:.2f}",
                     360.0 * report.lift_share, summary.lift_direction > 0 ? "counter-clockwise" : "clockwise",
                     report.time_ratio);
}

std::string crank_rocker_text(const LinkageSummary& summary, const calib::CrankRockerReport& report) {
  const double tick_deg = 360.0 / static_cast<double>(summary.model.encoder.ticks_per_turn);
  std::string text = line("swing", fmt::format("{:.1f} deg", deg_from_rad(report.swing_rad)));
  text += line("lift", lift_text(summary, report));
  text += line("dead points", end_text(summary.begin) + ", where the lift begins");
  text += line("", end_text(summary.end) + ", where it ends");
  text += line("transmission", fmt::format("at least {:.1f} deg", deg_from_rad(report.least_transmission_rad)));
  text += line("rate", fmt::format("the rocker at most {:.2f} times the crank's: an encoder's tick ({} a turn) is at "
                                   "most {:.4f} deg of elevation",
                                   report.most_rocker_rate, summary.model.encoder.ticks_per_turn,
                                   tick_deg * report.most_rocker_rate));
  const Extremes extremes = extremes_of(summary);
  text += line("acceleration",
               fmt::format("at most {:.2f} per radian of the crank, turning evenly", extremes.most_acceleration));
  text += line("sensitivity", fmt::format("at most crank {:.2f}, coupler {:.2f}, rocker {:.2f}, ground {:.2f} deg of "
                                          "elevation per mm",
                                          deg_per_mm(extremes.most.crank), deg_per_mm(extremes.most.coupler),
                                          deg_per_mm(extremes.most.rocker), deg_per_mm(extremes.most.ground)));
  return text;
}

std::string stretches_text(const LinkageSummary& summary) {
  std::string text;
  const char* name = "crank";
  for (const calib::CrankRange& range : calib::crank_ranges(summary.model.bars)) {
    const bool is_whole = range.to_rad - range.from_rad >= kTwoPi;
    text += line(name, is_whole ? "turns fully"
                                : fmt::format("the loop closes from {:.1f} to {:.1f} deg", deg_from_rad(range.from_rad),
                                              deg_from_rad(range.to_rad)));
    name = "";
  }
  text += line("ends", end_text(summary.begin));
  return text + line("", end_text(summary.end));
}

Json json_of_end(const LinkageEnd& end) {
  return {{"crank_deg", positive_deg(end.crank_rad)},
          {"rocker_deg", deg_from_rad(end.rocker_rad)},
          {"elevation_deg", deg_from_rad(end.elevation_rad)}};
}

Json json_of_ranges(const FourBar& bars) {
  Json ranges = Json::array();
  for (const calib::CrankRange& range : calib::crank_ranges(bars)) {
    ranges.push_back({{"from_deg", deg_from_rad(range.from_rad)}, {"to_deg", deg_from_rad(range.to_rad)}});
  }
  return ranges;
}

Json json_of_report(const LinkageSummary& summary, const calib::CrankRockerReport& report) {
  const Extremes extremes = extremes_of(summary);
  return {{"swing_deg", deg_from_rad(report.swing_rad)},
          {"lift_begin", json_of_end(summary.begin)},
          {"lift_end", json_of_end(summary.end)},
          {"lift_deg", 360.0 * report.lift_share},
          {"lift_direction", summary.lift_direction},
          {"time_ratio", report.time_ratio},
          {"least_transmission_deg", deg_from_rad(report.least_transmission_rad)},
          {"most_rocker_rate", report.most_rocker_rate},
          {"most_rocker_acceleration_per_rad", extremes.most_acceleration},
          {"most_sensitivity_deg_per_mm",
           {{"crank", deg_per_mm(extremes.most.crank)},
            {"coupler", deg_per_mm(extremes.most.coupler)},
            {"rocker", deg_per_mm(extremes.most.rocker)},
            {"ground", deg_per_mm(extremes.most.ground)}}}};
}

}  // namespace

std::string degrees_text(double angle_rad) {
  std::string text = fmt::format("{:.1f}", deg_from_rad(angle_rad));
  return text == "-0.0" ? "0.0" : text;
}

std::string as_text(const LinkageSummary& summary) {
  const calib::FreudensteinCoefficients k = calib::freudenstein(summary.model.bars);
  std::string text = line("linkage", summary.model.name);
  text += line("bars", bars_text(summary));
  text += line("class",
               fmt::format("{}: {}", calib::class_name(summary.grashof), calib::inequality_text(summary.model.bars)));
  text += summary.report ? crank_rocker_text(summary, *summary.report) : stretches_text(summary);
  text += line("Freudenstein", fmt::format("K1 {:.6f}, K2 {:.6f}, K3 {:.6f}", k.k1, k.k2, k.k3));
  for (const std::string& remark : summary.remarks) {
    text += line("remark", remark);
  }
  return text;
}

Json as_json(const LinkageSummary& summary) {
  const FourBar& bars = summary.model.bars;
  const calib::GrashofInequality sums = calib::grashof_inequality(bars);
  const calib::FreudensteinCoefficients k = calib::freudenstein(bars);
  Json json = {
      {"name", summary.model.name},
      {"bars_m",
       {{"crank", bars.crank_m}, {"coupler", bars.coupler_m}, {"rocker", bars.rocker_m}, {"ground", bars.ground_m}}},
      {"assembly", summary.model.assembly == calib::Assembly::kOpen ? "open" : "crossed"},
      {"class", calib::class_name(summary.grashof)},
      {"shortest_and_longest_m", sums.extremes_m},
      {"other_two_m", sums.middles_m},
      {"crank_ranges", json_of_ranges(bars)},
      {"freudenstein", {k.k1, k.k2, k.k3}}};
  json["crank_rocker"] = summary.report ? json_of_report(summary, *summary.report) : Json();
  json["remarks"] = summary.remarks;
  return json;
}

}  // namespace gdtslam
