// Turns, crops, cleans and georeferences the map of a run (`gdtslam edit`). The run itself is not changed: its
// keyframes are moved and all outputs made from them, so that turning blurs no picture. The same bytes on every run.
// One call belongs to one thread. Cost: reading the logs and casting their scans, then some 0.5 ms a keyframe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/edits/edit_steps.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// "X,Y" or "X,Y,THETA"; THETA is in degrees and may be left out.
struct StatedOrigin {
  Pose2 pose;
  bool has_angle = false;
};
/// Throws UsageError.
StatedOrigin parse_origin(const std::string& text);

/// "X0,Y0,X1,Y1": two opposite corners in any order. Throws UsageError if it has no area.
RegionBounds parse_rectangle(const std::string& text);

/// "x,y x,y x,y ...": three corners and more; or a file with one corner in each line, "x,y" or "x y"; `#` begins a
/// comment. Throws UsageError for the text, InputError with file and line for the file, FileError.
MapRegion parse_region(const std::string& text_or_file);

/// "x,y=E,N", a point; or a file with one point in each line, "x,y=E,N", "x,y,E,N" or "x y E N". Throws like
/// parse_region().
std::vector<PointPair> parse_point_pairs(const std::string& text_or_file);

struct EditRequest {
  std::string run{};     ///< folder of a run of `map`, `merge` or `edit`
  std::string folder{};  ///< folder of the results; made if need be
  std::string again{};   ///< edits.json with steps to do first; empty: none
  // In the frame of the run, with the steps of `again` done:
  std::vector<PointPair> points{};  ///< points with known world coordinates
  std::optional<StatedOrigin> origin{};
  bool along_walls = false;  ///< the x axis
  bool north_up = false;     ///< the y axis
  // In the new frame:
  std::vector<MapRegion> erased{};
  std::optional<RegionBounds> crop{};
  bool with_world_file = false;
  bool with_tiles = false;  ///< the map in tiles too

  bool with_pictures = true;
  bool replace_foreign_files = false;  ///< foreign files in the folder are removed; otherwise the folder is refused

  std::function<void(std::string_view step, double share)>
      progress{};  ///< the current step and the share of it that is done
  std::function<bool()> stop{};
};

struct EditOutcome {
  std::vector<EditStep> steps;  ///< steps of this edit, including those of `again`
  EditPlan plan;                ///< the steps combined
  std::size_t tiles = 0;
  std::uint64_t readings = 0;                ///< readings removed from keyframes
  std::uint64_t scans = 0;                   ///< scans cast into the occupancy map; 0: its cells are those of the run
  bool is_of_keyframes = false;              ///< cast from keyframes, because the run's logs are gone or were changed
  std::string edits;                         ///< the text of edits.json
  std::vector<LogReader::Warning> warnings;  ///< pictures that could not be made
};

/// Throws UsageError if the steps contradict each other, InputError if the run cannot be edited, FileError, and
/// Error(kInterrupted) if stop() became true; then nothing is written.
EditOutcome edit_run(const EditRequest& request);

}  // namespace gdtslam
