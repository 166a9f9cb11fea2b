// What a linkage does, as `gdtslam linkage` shows it: one summary and one row for each crank angle. Angles in degrees
// in everything that is printed, lengths in metres (JSON) or centimetres (text). Thread-safe; O(rows).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/calib/sweep_model.hpp"

namespace gdtslam {

/// A place of the crank where the rocker turns back, or where the loop stops closing.
struct LinkageEnd {
  double crank_rad = 0.0;
  double rocker_rad = 0.0;
  double elevation_rad = 0.0;
};

/// A linkage over the part of the turn in which it moves, in the order in which it is best read: a crank-rocker through
/// one turn from where the lift begins, in the direction that makes lifting the slow stroke; any other through the
/// first stretch in which its loop closes.
struct LinkageSummary {
  calib::SweepModel model;
  calib::GrashofClass grashof = calib::GrashofClass::kTripleRocker;
  std::optional<calib::CrankRockerReport> report;  ///< of a crank-rocker
  LinkageEnd begin;
  LinkageEnd end;          ///< of the lift, or of the stretch
  double from_rad = 0.0;   ///< crank angle
  double span_rad = 0.0;   ///< signed, what the drawing's plots show
  int lift_direction = 1;  ///< of the crank, +1 counter-clockwise
  std::vector<std::string> remarks;
};
/// Throws ConfigError when the loop cannot close, with the inequality.
LinkageSummary summary_of(const calib::SweepModel& model);

struct LinkageRow {
  double crank_rad = 0.0;
  double elevation_rad = 0.0;
  calib::LinkagePose pose;
  std::optional<calib::LinkageMotion> motion;           ///< none where the crank is at a dead point
  std::optional<calib::RockerSensitivity> sensitivity;  ///< likewise
};
std::optional<LinkageRow> row_at(const calib::SweepModel& model, double crank_rad);
/// `steps` + 1 rows evenly over the summary's span; crank angles where the loop does not close are left out.
std::vector<LinkageRow> rows_of(const LinkageSummary& summary, int steps);

/// One decimal, without a unit and never "-0.0".
std::string degrees_text(double angle_rad);
std::string as_text(const LinkageSummary& summary);
nlohmann::ordered_json as_json(const LinkageSummary& summary);
/// A heading with units and one line for each row; crank angles go from 0 to 360 deg.
std::string as_csv(const LinkageSummary& summary, double step_rad);

}  // namespace gdtslam
