// What a user writes of places: poses, rectangles, polygons and points that are known in the world, on the command line
// or in a file. Metres; angles in degrees. Thread-safe; linear in the text.
#pragma once

#include <string>
#include <vector>

#include "engine/runs/edits/georeference.hpp"
#include "engine/runs/edits/map_region.hpp"

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

}  // namespace gdtslam
