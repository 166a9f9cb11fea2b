#include "linkage_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/drawing/plots/linkage_drawing.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;
using calib::FourBar;
using calib::LinkageCycle;
using calib::LinkagePosition;
using calib::SweepModel;

constexpr int kScanSteps = 1440;

/// The extremes over the cycle, without dead points of the crank.
struct Extremes {
  double acceleration = 0.0;
  calib::RockerSensitivity by;
};

Extremes extremes_over(const LinkageCycle& cycle) {
  const SweepModel& model = cycle.model();
  Extremes most;
  for (int i = 0; i <= kScanSteps; ++i) {
    const double crank_rad = cycle.from_rad() + cycle.span_rad() * i / kScanSteps;
    const auto motion = calib::motion(model.bars, model.assembly, crank_rad);
    const auto by = calib::sensitivity(model.bars, model.assembly, crank_rad);
    if (!motion || !by) continue;
    const auto raise = [](double& highest, double value) { highest = std::max(highest, std::fabs(value)); };
    raise(most.acceleration, motion->rocker_acceleration);
    raise(most.by.crank, by->crank);
    raise(most.by.coupler, by->coupler);
    raise(most.by.rocker, by->rocker);
    raise(most.by.ground, by->ground);
  }
  return most;
}

// Radians per metre in degrees per millimetre.
double deg_per_mm(double rad_per_m) { return deg_from_rad(rad_per_m) / 1000.0; }
double positive_deg(double angle_rad) {
  const double turns = angle_rad / kTwoPi;
  return 360.0 * (turns - std::floor(turns));
}

std::string line(const char* name, const std::string& text) { return fmt::format("{:<14} {}\n", name, text); }

std::string cm(double length_m) { return fmt::format("{:.6g}", 100.0 * length_m); }

std::string bars_text(const LinkageCycle& cycle) {
  const FourBar& bars = cycle.model().bars;
  return fmt::format("crank {}, coupler {}, rocker {}, ground {} cm; {} assembly", cm(bars.crank_m), cm(bars.coupler_m),
                     cm(bars.rocker_m), cm(bars.ground_m),
                     cycle.model().assembly == calib::Assembly::kOpen ? "open" : "crossed");
}

// The elevation without the full turns that keep it continuous over the cycle.
double elevation_rad(const LinkageCycle& cycle, const LinkagePosition& end) {
  return calib::elevation_rad(cycle.model(), end.crank_rad).value_or(end.elevation_rad);
}

std::string end_text(const LinkageCycle& cycle, const LinkagePosition& end) {
  return fmt::format("crank {:5.1f} deg: rocker {:>6} deg, elevation {:>5} deg", positive_deg(end.crank_rad),
                     degrees_text(end.pose.rocker_rad), degrees_text(elevation_rad(cycle, end)));
}

std::string lift_text(const LinkageCycle& cycle, const calib::CrankRockerReport& report) {
  return fmt::format("{:.1f} of 360 deg, the crank turning {} in the linkage's frame; time ratio {:.2f}",
                     360.0 * report.lift_share, cycle.span_rad() > 0.0 ? "counter-clockwise" : "clockwise",
                     report.time_ratio);
}

std::string crank_rocker_text(const LinkageCycle& cycle, const calib::CrankRockerReport& report) {
  const double tick_deg = 360.0 / static_cast<double>(cycle.model().encoder.ticks_per_turn);
  std::string text = line("swing", fmt::format("{:.1f} deg", deg_from_rad(report.swing_rad)));
  text += line("lift", lift_text(cycle, report));
  text += line("dead points", end_text(cycle, cycle.begin()) + ", where the lift begins");
  text += line("", end_text(cycle, cycle.end()) + ", where it ends");
  text += line("transmission", fmt::format("at least {:.1f} deg", deg_from_rad(report.least_transmission_rad)));
  text += line("rate", fmt::format("the rocker at most {:.2f} times the crank's: an encoder's tick ({} a turn) is at "
                                   "most {:.4f} deg of elevation",
                                   report.most_rocker_rate, cycle.model().encoder.ticks_per_turn,
                                   tick_deg * report.most_rocker_rate));
  const Extremes extremes = extremes_over(cycle);
  text += line("acceleration",
               fmt::format("at most {:.2f} per radian of the crank, turning evenly", extremes.acceleration));
  text += line("sensitivity", fmt::format("at most crank {:.2f}, coupler {:.2f}, rocker {:.2f}, ground {:.2f} deg of "
                                          "elevation per mm",
                                          deg_per_mm(extremes.by.crank), deg_per_mm(extremes.by.coupler),
                                          deg_per_mm(extremes.by.rocker), deg_per_mm(extremes.by.ground)));
  return text;
}

std::string stretches_text(const LinkageCycle& cycle) {
  std::string text;
  const char* name = "crank";
  for (const calib::CrankRange& range : calib::crank_ranges(cycle.model().bars)) {
    const bool is_whole = range.to_rad - range.from_rad >= kTwoPi;
    text += line(name, is_whole ? "turns fully"
                                : fmt::format("the loop closes from {:.1f} to {:.1f} deg", deg_from_rad(range.from_rad),
                                              deg_from_rad(range.to_rad)));
    name = "";
  }
  text += line("ends", end_text(cycle, cycle.begin()));
  return text + line("", end_text(cycle, cycle.end()));
}

Json end_json(const LinkageCycle& cycle, const LinkagePosition& end) {
  return {{"crank_deg", positive_deg(end.crank_rad)},
          {"rocker_deg", deg_from_rad(end.pose.rocker_rad)},
          {"elevation_deg", deg_from_rad(elevation_rad(cycle, end))}};
}

Json ranges_json(const FourBar& bars) {
  Json ranges = Json::array();
  for (const calib::CrankRange& range : calib::crank_ranges(bars)) {
    ranges.push_back({{"from_deg", deg_from_rad(range.from_rad)}, {"to_deg", deg_from_rad(range.to_rad)}});
  }
  return ranges;
}

Json report_json(const LinkageCycle& cycle, const calib::CrankRockerReport& report) {
  const Extremes extremes = extremes_over(cycle);
  return {{"swing_deg", deg_from_rad(report.swing_rad)},
          {"lift_begin", end_json(cycle, cycle.begin())},
          {"lift_end", end_json(cycle, cycle.end())},
          {"lift_deg", 360.0 * report.lift_share},
          {"lift_direction", cycle.span_rad() > 0.0 ? 1 : -1},
          {"time_ratio", report.time_ratio},
          {"least_transmission_deg", deg_from_rad(report.least_transmission_rad)},
          {"most_rocker_rate", report.most_rocker_rate},
          {"most_rocker_acceleration_per_rad", extremes.acceleration},
          {"most_sensitivity_deg_per_mm",
           {{"crank", deg_per_mm(extremes.by.crank)},
            {"coupler", deg_per_mm(extremes.by.coupler)},
            {"rocker", deg_per_mm(extremes.by.rocker)},
            {"ground", deg_per_mm(extremes.by.ground)}}}};
}

const char* fault_text(calib::GrashofClass grashof) {
  using calib::GrashofClass;
  switch (grashof) {
    case GrashofClass::kDoubleCrank:
      return "its rocker turns fully instead of swinging";
    case GrashofClass::kRockerCrank:
      return "its rocker could turn fully and the crank only swings";
    case GrashofClass::kChangePoint:
      return "it can fall flat, and then go on in the other assembly mode";
    default:
      return "its crank does not turn fully";
  }
}

// Remarks for a designer.
std::vector<std::string> all_remarks(const LinkageCycle& cycle) {
  const SweepModel& model = cycle.model();
  if (cycle.report()) return calib::remarks(model.bars, model.assembly);
  return {fmt::format(
      "a {} is no mount for a nodding laser: {}; a crank-rocker has the crank as its shortest bar, and shortest + "
      "longest less than the other two",
      calib::class_name(cycle.grashof()), fault_text(cycle.grashof()))};
}

std::string csv_line(const SweepModel& model, const LinkagePosition& position) {
  const auto motion = calib::motion(model.bars, model.assembly, position.crank_rad);
  const auto by = calib::sensitivity(model.bars, model.assembly, position.crank_rad);
  std::string text = fmt::format("{:.4f},{:.6f},{:.6f},{:.6f}", deg_from_rad(position.crank_rad),
                                 deg_from_rad(position.pose.rocker_rad), deg_from_rad(position.elevation_rad),
                                 deg_from_rad(position.pose.transmission_rad));
  text += motion ? fmt::format(",{:.6f},{:.6f}", motion->rocker_rate, motion->rocker_acceleration) : ",,";
  return text + (by ? fmt::format(",{:.6f},{:.6f},{:.6f},{:.6f}\n", deg_per_mm(by->crank), deg_per_mm(by->coupler),
                                  deg_per_mm(by->rocker), deg_per_mm(by->ground))
                    : ",,,,\n");
}

}  // namespace

std::string as_text(const LinkageCycle& cycle) {
  const calib::FreudensteinCoefficients k = calib::freudenstein(cycle.model().bars);
  std::string text = line("linkage", cycle.model().name);
  text += line("bars", bars_text(cycle));
  text += line("class",
               fmt::format("{}: {}", calib::class_name(cycle.grashof()), calib::inequality_text(cycle.model().bars)));
  text += cycle.report() ? crank_rocker_text(cycle, *cycle.report()) : stretches_text(cycle);
  text += line("Freudenstein", fmt::format("K1 {:.6f}, K2 {:.6f}, K3 {:.6f}", k.k1, k.k2, k.k3));
  for (const std::string& remark : all_remarks(cycle)) {
    text += line("remark", remark);
  }
  return text;
}

Json as_json(const LinkageCycle& cycle) {
  const FourBar& bars = cycle.model().bars;
  const calib::GrashofInequality sums = calib::grashof_inequality(bars);
  const calib::FreudensteinCoefficients k = calib::freudenstein(bars);
  Json json = {
      {"name", cycle.model().name},
      {"bars_m",
       {{"crank", bars.crank_m}, {"coupler", bars.coupler_m}, {"rocker", bars.rocker_m}, {"ground", bars.ground_m}}},
      {"assembly", cycle.model().assembly == calib::Assembly::kOpen ? "open" : "crossed"},
      {"class", calib::class_name(cycle.grashof())},
      {"shortest_and_longest_m", sums.extremes_m},
      {"other_two_m", sums.middles_m},
      {"crank_ranges", ranges_json(bars)},
      {"freudenstein", {k.k1, k.k2, k.k3}}};
  json["crank_rocker"] = cycle.report() ? report_json(cycle, *cycle.report()) : Json();
  json["remarks"] = all_remarks(cycle);
  return json;
}

std::string as_csv(const SweepModel& model, double step_rad) {
  std::string text =
      "crank_deg,rocker_deg,elevation_deg,transmission_deg,rocker_rate,rocker_acceleration_per_rad,"
      "rocker_by_crank_deg_per_mm,rocker_by_coupler_deg_per_mm,rocker_by_rocker_deg_per_mm,"
      "rocker_by_ground_deg_per_mm\n";
  constexpr double kRounding = 1e-9;
  const auto steps = static_cast<int>(std::floor(kTwoPi / step_rad + kRounding));
  for (int i = 0; i <= steps; ++i) {
    if (const auto position = calib::position_at(model, i * step_rad)) text += csv_line(model, *position);
  }
  return text;
}

}  // namespace gdtslam
