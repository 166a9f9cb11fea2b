// The options of `gdtslam render`: as they were typed, and what they mean. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/viewer/camera.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"

namespace gdtslam {

/// What the command line says; empty or 0: not said.
struct RenderOptions {
  std::vector<std::string> inputs;
  RecordingOptions recording;
  std::string output;
  std::string view;
  std::string size;
  std::string colour;
  std::string colour_map;
  std::string range;
  std::string reference;
  std::string relations;
  std::string camera;
  std::string title;
  std::string at;
  std::string from;
  std::string to;
  std::string seconds;
  std::string linkage;
  std::string run_folder;
  std::string ffmpeg;
  std::size_t cells = 0;
  std::size_t frames = 0;
  std::uint64_t points = 0;
  double frames_per_s = 0.0;
  double point_px = 0.0;
  bool is_squared = false;
  bool is_angle = false;  ///< errors of the heading instead of the position
  bool is_transparent = false;
  bool is_light = false;
  bool is_dark = false;
  bool no_floor = false;
  bool no_ceiling = false;
  bool with_ceiling = false;
  bool no_path = false;
  bool no_caption = false;
  bool lists_views = false;
  bool force = false;
  bool json = false;
  bool quiet = false;
};

/// Whether there is something to hold a trajectory against: relations, or a reference that is a trajectory.
bool has_truth(const RenderOptions& options);
/// The second of the two.
bool has_true_path(const RenderOptions& options);
/// "1280x720". Throws UsageError, as all of these do.
PictureSize size_of(const std::string& text);
CloudColour cloud_colour_of(const std::string& name);
/// "MIN:MAX" with the units of the colour's quantity; either side may be empty.
struct ScaleRange {
  std::optional<double> least;
  std::optional<double> most;
};
ScaleRange scale_range_of(const std::string& text, CloudColour colour);
/// "X,Y", lengths.
Point2 place_of(const std::string& text);
/// A time, in seconds.
double time_of(const std::string& option, const std::string& text);
/// The name itself, where a colour map has it; empty stays empty.
std::string colour_map_of(const std::string& name);
/// Everything about a cloud's look but floor and ceiling, which depend on the view.
CloudLook cloud_look_of(const RenderOptions& options);
/// Names of all colour maps, and of all colours.
std::string colour_map_names();

}  // namespace gdtslam
