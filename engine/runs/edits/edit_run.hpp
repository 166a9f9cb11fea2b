// A run whose map is turned, cropped, cleaned and georeferenced: what `gdtslam edit` does. The run itself is left
// alone; its keyframes are moved and all outputs made anew from them, so that nothing is blurred by turning pictures.
// The same bytes on every run. One call belongs to one thread. Cost: as reading the copies of the logs and casting
// their scans, then some 0.5 ms a keyframe.
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

/// "X0,Y0,X1,Y1": two corners, whichever. Throws UsageError where it has no area.
RegionBounds parse_rectangle(const std::string& text);

/// "x,y x,y x,y ...": three corners and more; or a file with a corner a line, "x,y" or "x y", where `#` begins a
/// comment. Throws UsageError for the text, InputError with file and line for the file, FileError.
MapRegion parse_region(const std::string& text_or_file);

/// "x,y=E,N", a point; or a file with a point a line, "x,y=E,N", "x,y,E,N" or "x y E N". Throws likewise.
std::vector<PointPair> parse_point_pairs(const std::string& text_or_file);

struct EditRequest {
  std::string run{};     ///< folder of `map` or `merge`, or one that was edited
  std::string folder{};  ///< folder of the results; made if need be
  std::string again{};   ///< edits.json whose steps are done first; empty: none
  // In the frame of the run, with the steps of `again` done:
  std::vector<PointPair> points{};  ///< known in the world
  std::optional<StatedOrigin> origin{};
  bool along_walls = false;  ///< the x axis
  bool north_up = false;     ///< the y axis
  // In the new frame:
  std::vector<MapRegion> erased{};
  std::optional<RegionBounds> crop{};
  bool with_world_file = false;
  bool with_tiles = false;  ///< the map in tiles too

  bool with_pictures = true;
  bool replace_foreign_files = false;  ///< files in the folder that no run wrote are removed, else it is refused

  std::function<void(std::string_view step, double share)>
      progress{};  ///< the step at work, and its share that is done
  std::function<bool()> stop{};
};

struct EditOutcome {
  std::vector<EditStep> steps;  ///< steps of this edit, those of `again` among them
  EditPlan plan;                ///< the steps combined
  std::size_t tiles = 0;
  std::uint64_t readings = 0;    ///< taken out of keyframes
  std::uint64_t scans = 0;       ///< that the occupancy map was cast from; 0: its cells are those of the run
  bool is_of_keyframes = false;  ///< the run's logs are gone or were changed
  std::string edits;             ///< the text of edits.json
  std::vector<LogReader::Warning> warnings;  ///< pictures that could not be made
};

/// Throws UsageError where the steps make no sense together, InputError where the run cannot be edited, FileError, and
/// Error(kInterrupted) where stop() became true: then nothing is written.
EditOutcome edit_run(const EditRequest& request);

}  // namespace gdtslam
