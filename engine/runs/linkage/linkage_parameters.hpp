// The calibrated parameters that a linkage file may state the uncertainty of. Thread-safe.
#pragma once

#include <array>

#include "gdtslam/core/units.hpp"

namespace gdtslam {

struct LinkageParameter {
  const char* name;  ///< as calib::CalibratedParameter has it
  Unit unit;
};

inline constexpr std::array<LinkageParameter, 10> kLinkageParameters{{{"crank", Unit::kMetre},
                                                                      {"coupler", Unit::kMetre},
                                                                      {"rocker", Unit::kMetre},
                                                                      {"ground", Unit::kMetre},
                                                                      {"zero", Unit::kRadian},
                                                                      {"offset", Unit::kRadian},
                                                                      {"lever.forward", Unit::kMetre},
                                                                      {"lever.up", Unit::kMetre},
                                                                      {"sensor.roll", Unit::kRadian},
                                                                      {"sensor.yaw", Unit::kRadian}}};

}  // namespace gdtslam
