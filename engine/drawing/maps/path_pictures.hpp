// Pictures of paths without a map: one in the colours of time, several over the truth, one in the colours of its error.
// Frame: the map's or the truth's, metres, y up. Thread-safe; O(poses).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"

namespace gdtslam {

/// Of a still whose size nobody asks for: one that suits where these paths lie.
PictureSize size_for_paths(const std::vector<const Trajectory*>& paths);

/// As the map's picture has it. Throws InputError where an index is beyond the trajectory.
Canvas trajectory_picture(const PathOverlay& path, const MapLook& look, const PictureSize& size);

/// A path with its name for the legend.
struct NamedPath {
  std::string name;
  Trajectory trajectory;
  std::vector<std::size_t> drives{};
};
/// Each in a colour of its own; the truth, where there is one, broad and grey under them.
Canvas trajectories_picture(const std::vector<NamedPath>& paths, const Trajectory* truth, const MapLook& look,
                            const PictureSize& size);

/// A path in the frame of the truth with the error at each pose, which is no number where the truth has no such stamp.
struct PathErrors {
  const Trajectory& trajectory;
  const std::vector<std::size_t>& drives;
  const std::vector<double>& errors;
  std::string quantity;         ///< with its unit: "Position error (m)"
  std::optional<double> least;  ///< of the scale; nothing: 0
  std::optional<double> most;   ///< likewise the largest error, or the 99th percentile
};
/// The truth thin and grey below; a colour bar with the scale's ends. Throws InputError without any error.
Canvas path_errors_picture(const PathErrors& path, const Trajectory& truth, const MapLook& look,
                           const PictureSize& size);

}  // namespace gdtslam
