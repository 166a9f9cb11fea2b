// The report of `gdtslam linkage`. Angles in degrees, lengths in metres (JSON) or centimetres (text). Thread-safe;
// O(rows).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "calib/linkage/linkage_cycle.hpp"

namespace gdtslam {

std::string as_text(const calib::LinkageCycle& cycle);
nlohmann::ordered_json as_json(const calib::LinkageCycle& cycle);
/// A heading with units and one line per row. Crank angles go from 0 to 360 deg; rows where the loop does not close are
/// skipped.
std::string as_csv(const calib::SweepModel& model, double step_rad);

}  // namespace gdtslam
