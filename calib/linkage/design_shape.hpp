// Shapes of crank-rockers from their dead points [Norton2012]: in both of them crank and coupler are in line, so the
// triangle of the crank's pivot and the rocker's two outermost ends has the sides coupler + crank and coupler - crank
// and, between these, the angle by which the strokes differ. Lengths in cranks, angles in radians. Thread-safe,
// constant time.
#pragma once

#include <optional>

#include "gdtslam/calib/four_bar.hpp"

namespace gdtslam::calib {

/// What a shape is made of. The crank's pivot lies on the side of the rocker's pivot of the line through the rocker's
/// outermost ends; on the other side there are crank-rockers too, which transmit worse.
struct ShapeChoice {
  double swing_rad = 0.0;
  double imbalance_rad = 0.0;  ///< the slow stroke takes pi + imbalance of the turn, 0 to pi
  double coupler = 0.0;        ///< over the crank, above 1
};

/// The bars for a crank of 1, or nothing where the choice is no crank-rocker with that swing.
std::optional<FourBar> shape(const ShapeChoice& choice);

/// The largest |cos| of the transmission angle over a turn.
double worst_transmission_cosine(const FourBar& bars);

double imbalance_of_time_ratio(double time_ratio);

}  // namespace gdtslam::calib
