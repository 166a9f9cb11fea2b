#include "linkage_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using calib::CrankRange;
using calib::SweepModel;

constexpr int kStretchSteps = 720;

LinkageEnd end_at(const SweepModel& model, double crank_rad) {
  const std::optional<LinkageRow> row = row_at(model, crank_rad);
  if (!row) {
    throw ConfigError(fmt::format("the loop does not close at a crank angle of {:.3f} deg", deg_from_rad(crank_rad)));
  }
  return {.crank_rad = crank_rad, .rocker_rad = row->pose.rocker_rad, .elevation_rad = row->elevation_rad};
}

// Where the elevation falls with the rocker's angle, the lift is the way from the rocker's highest to its lowest place.
void add_lift(LinkageSummary& summary) {
  const SweepModel& model = summary.model;
  summary.report = calib::analyse(model.bars, model.assembly);
  const calib::CrankRockerReport& report = *summary.report;
  const bool is_rising = model.elevation_sign > 0;
  summary.begin = end_at(model, is_rising ? report.lowest.crank_rad : report.highest.crank_rad);
  summary.end = end_at(model, is_rising ? report.highest.crank_rad : report.lowest.crank_rad);
  summary.lift_direction = is_rising ? report.lift_direction : -report.lift_direction;
  summary.from_rad = summary.begin.crank_rad;
  summary.span_rad = summary.lift_direction * kTwoPi;
  summary.remarks = calib::remarks(model.bars, model.assembly);
}

const char* fault_of(calib::GrashofClass grashof) {
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

std::string no_crank_rocker_remark(calib::GrashofClass grashof) {
  return fmt::format(
      "a {} is no mount for a nodding laser: {}; a crank-rocker has the crank as its shortest bar, and shortest + "
      "longest less than the other two",
      calib::class_name(grashof), fault_of(grashof));
}

void add_stretch(LinkageSummary& summary) {
  const std::vector<CrankRange> ranges = calib::crank_ranges(summary.model.bars);
  if (ranges.empty()) {
    throw ConfigError("the loop closes at no crank angle");
  }
  summary.from_rad = ranges.front().from_rad;
  summary.span_rad = ranges.front().to_rad - ranges.front().from_rad;
  const std::vector<LinkageRow> rows = rows_of(summary, kStretchSteps);
  if (rows.empty()) {
    throw ConfigError("the loop closes in no stretch of the crank's turn");
  }
  const auto end_of = [](const LinkageRow& row) {
    return LinkageEnd{
        .crank_rad = row.crank_rad, .rocker_rad = row.pose.rocker_rad, .elevation_rad = row.elevation_rad};
  };
  summary.begin = end_of(rows.front());
  summary.end = end_of(rows.back());
  summary.remarks.push_back(no_crank_rocker_remark(summary.grashof));
}

std::string value_or_nothing(bool is_there, double value) { return is_there ? fmt::format("{:.6f}", value) : ""; }

// Radians per metre, as degrees per millimetre.
double deg_per_mm(double rad_per_m) { return deg_from_rad(rad_per_m) / 1000.0; }

std::string csv_line(double crank_deg, const LinkageRow& row) {
  const calib::LinkageMotion motion = row.motion.value_or(calib::LinkageMotion{});
  const calib::RockerSensitivity by = row.sensitivity.value_or(calib::RockerSensitivity{});
  const bool moves = row.motion.has_value();
  const bool is_smooth = row.sensitivity.has_value();
  return fmt::format(
      "{:.4f},{:.6f},{:.6f},{:.6f},{},{},{},{},{},{}\n", crank_deg, deg_from_rad(row.pose.rocker_rad),
      deg_from_rad(row.elevation_rad), deg_from_rad(row.pose.transmission_rad),
      value_or_nothing(moves, motion.rocker_rate), value_or_nothing(moves, motion.rocker_acceleration),
      value_or_nothing(is_smooth, deg_per_mm(by.crank)), value_or_nothing(is_smooth, deg_per_mm(by.coupler)),
      value_or_nothing(is_smooth, deg_per_mm(by.rocker)), value_or_nothing(is_smooth, deg_per_mm(by.ground)));
}

}  // namespace

LinkageSummary summary_of(const SweepModel& model) {
  const std::vector<std::string> wrong = calib::violations(model.bars);
  if (!wrong.empty()) {
    throw ConfigError(wrong.front());
  }
  LinkageSummary summary;
  summary.model = model;
  summary.grashof = calib::grashof_class(model.bars);
  if (summary.grashof == calib::GrashofClass::kCrankRocker) {
    add_lift(summary);
  } else {
    add_stretch(summary);
  }
  return summary;
}

std::optional<LinkageRow> row_at(const SweepModel& model, double crank_rad) {
  const std::optional<calib::LinkagePose> pose = calib::solve(model.bars, model.assembly, crank_rad);
  const std::optional<double> elevation_rad = calib::elevation_rad(model, crank_rad);
  if (!pose || !elevation_rad) {
    return std::nullopt;
  }
  return LinkageRow{.crank_rad = crank_rad,
                    .elevation_rad = *elevation_rad,
                    .pose = *pose,
                    .motion = calib::motion(model.bars, model.assembly, crank_rad),
                    .sensitivity = calib::sensitivity(model.bars, model.assembly, crank_rad)};
}

std::vector<LinkageRow> rows_of(const LinkageSummary& summary, int steps) {
  std::vector<LinkageRow> rows;
  for (int i = 0; i <= steps; ++i) {
    const std::optional<LinkageRow> row = row_at(summary.model, summary.from_rad + summary.span_rad * i / steps);
    if (row) {
      rows.push_back(*row);
    }
  }
  return rows;
}

std::string as_csv(const LinkageSummary& summary, double step_rad) {
  std::string text =
      "crank_deg,rocker_deg,elevation_deg,transmission_deg,rocker_rate,rocker_acceleration_per_rad,"
      "rocker_by_crank_deg_per_mm,rocker_by_coupler_deg_per_mm,rocker_by_rocker_deg_per_mm,"
      "rocker_by_ground_deg_per_mm\n";
  constexpr double kRounding = 1e-9;
  const auto steps = static_cast<int>(std::floor(kTwoPi / step_rad + kRounding));
  for (int i = 0; i <= steps; ++i) {
    const double crank_rad = i * step_rad;
    const std::optional<LinkageRow> row = row_at(summary.model, crank_rad);
    if (row) {
      text += csv_line(deg_from_rad(crank_rad), *row);
    }
  }
  return text;
}

}  // namespace gdtslam
