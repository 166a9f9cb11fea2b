// The steps of an edited map, with their numbers as resolved, what they come to, and edits.json, which has them so that
// they can be done again (docs/formats.md). Frames: each step is in the frame of the map before it, and so are its
// regions and points. Plain data; thread-safe; O(text).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/runs/edits/georeference.hpp"
#include "engine/runs/edits/map_region.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// In the folder of an edited run.
inline constexpr const char* kEditsFile = "edits.json";

/// A pose of the map becomes the origin of a new frame.
struct FrameEdit {
  enum class By : std::uint8_t { kStated, kWalls, kNorth };
  By by = By::kStated;       ///< what gave the direction
  Pose2 T_before_after{};    ///< the new origin
  double walls_share = 0.0;  ///< WallDirection::share, where walls gave it
};
/// Readings that end there are taken out.
struct EraseEdit {
  MapRegion region;
};
/// The rest is left out.
struct CropEdit {
  Point2 low_m;
  Point2 high_m;
};
/// Where the map lies in the world, from points.
struct GeoreferenceEdit {
  std::vector<PointPair> points;
  Georeference fit;
};
/// map.png and map.pgw are written.
struct WorldFileEdit {};

using EditStep = std::variant<FrameEdit, EraseEdit, CropEdit, GeoreferenceEdit, WorldFileEdit>;

/// What steps, one after the other, come to. Regions and T_world_map are in the frame after the last step.
struct EditPlan {
  Pose2 T_edited_run{};
  bool has_other_frame = false;
  std::vector<MapRegion> erased;
  std::vector<MapRegion> kept;  ///< what lies outside any of them is left out
  std::optional<Pose2> T_world_edited;
  bool with_world_file = false;
};

/// Goes on with what earlier steps came to, whose regions have been dealt with.
EditPlan plan_of(const std::vector<EditStep>& steps, const EditPlan& earlier = {});

struct RecordedEdits {
  std::string run;              ///< the folder that was edited, as it was named
  double begins_at_s = 0.0;     ///< stamp of the first pose of the run: who has another has another frame
  std::vector<EditStep> steps;  ///< from the first edit of a run that `map` or `merge` wrote
};

/// `readings` were taken out by the last edit.
std::string edits_text(const RecordedEdits& edits, std::size_t readings);

/// `name` stands in messages. Throws InputError with the step that is wrong and what to do.
RecordedEdits parse_edits(std::string_view text, const std::string& name);
/// Throws FileError too.
RecordedEdits read_edits(const std::string& file);

}  // namespace gdtslam
