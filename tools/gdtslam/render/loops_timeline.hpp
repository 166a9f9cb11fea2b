// Which frame of a film of closing loops shows what: the drive at an even pace, which stands still while the path bends
// where loops were found, then the last adjustment, the map, and a moment to look at it. Thread-safe; O(frames).
#pragma once

#include <cstddef>
#include <vector>

namespace gdtslam {

/// What a frame shows.
struct LoopsInstant {
  double driven_m = 0.0;   ///< how far the robot has come
  std::size_t stage = 0;   ///< the loops known: 0 none, one more than the drive has is the adjusted path
  double bent = 1.0;       ///< from the stage before, 0, to this one, 1
  double map_share = 0.0;  ///< of the map itself, which comes up at the end
  bool is_over = false;    ///< the robot has arrived
};

/// Of so many frames the last ones stand still.
struct LoopsFilmLength {
  std::size_t frames = 1;
  std::size_t held = 1;
};

/// So many stages leave each some frames to bend in.
std::size_t most_loop_stages(const LoopsFilmLength& length);

/// One entry a frame; the last ones are equal. `stages_m`: where on the way each stage of the drive begins, ascending,
/// without stage 0. `path_m`: of the whole drive.
std::vector<LoopsInstant> loops_timeline(const std::vector<double>& stages_m, double path_m,
                                         const LoopsFilmLength& length);

}  // namespace gdtslam
