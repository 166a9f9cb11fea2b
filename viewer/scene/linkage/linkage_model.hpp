// A nodding linkage as moving solids, for other programs: bars, joints, ground, laser and its fan, with colours and
// their poses over one turn of the crank. Frame: origin on the nodding axis, x forward, y left, z up; metres. Needs no
// OpenGL. Thread-safe; O(vertices).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/pose3.hpp"
#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {

/// Triangles of one colour in the frame of their part; counter-clockwise as seen from outside.
struct Solid {
  Colour colour;
  double opacity = 1.0;
  bool is_lit = true;  ///< false: shown in its colour in any light
  std::vector<std::array<float, 3>> places;
  std::vector<std::array<float, 3>> normals;  ///< one for each place
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
/// Solids that move together.
struct SolidPart {
  std::string name;
  std::vector<Solid> solids;
  std::vector<Pose3> poses;  ///< at equal steps of the crank over one turn; the last equals the first
  Pose3 shown;               ///< pose in a still
};
/// Throws ConfigError if the loop never closes.
std::vector<SolidPart> linkage_solids(const calib::SweepModel& model, int steps);

}  // namespace gdtslam
