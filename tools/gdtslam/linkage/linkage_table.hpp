// The report on a linkage that `gdtslam linkage` prints. Angles in degrees, lengths in metres (JSON) or centimetres
// (text). Thread-safe; O(rows).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "calib/linkage/linkage_cycle.hpp"

namespace gdtslam {

std::string as_text(const calib::LinkageCycle& cycle);
nlohmann::ordered_json as_json(const calib::LinkageCycle& cycle);
/// A heading with units and one line for each row; crank angles go from 0 to 360 deg, those where the loop does not
/// close are left out.
std::string as_csv(const calib::SweepModel& model, double step_rad);

}  // namespace gdtslam
