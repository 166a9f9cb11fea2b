// The options of `gdtslam render`: as typed, and their parsed values. Thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/viewer/camera.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {

/// Options of the command line; an empty text or 0 means that an option was not given.
struct RenderOptions {
  std::vector<std::string> inputs;
  std::string output;
  std::string view;
  std::string as;
  std::string from;
  std::string size;
  std::string title;
  std::string colour;
  std::string colour_map;
  std::string range;
  std::string background;
  std::string hide;
  std::string seconds;
  std::string time;
  std::string reference;
  std::string relations;
  std::string linkage;
  std::uint64_t points = 0;
  double frames_per_s = 0.0;
  bool lists_views = false;
  bool force = false;
  bool json = false;
  bool quiet = false;
};

/// Whether errors of a trajectory can be drawn: there are relations, or the reference is a trajectory.
bool has_truth(const RenderOptions& options);
/// Whether the reference is a trajectory.
bool has_true_path(const RenderOptions& options);

// Each of these throws UsageError for a text that it cannot read.

/// "1280x720".
PictureSize read_size(const std::string& text);

/// Camera: one of the presets, or one given by the user.
struct Viewpoint {
  CameraPreset preset = CameraPreset::kIso;
  std::optional<Camera> camera;
};
/// "iso", "top", "front", "side", "robot", or a camera (parse_camera). Empty is iso.
Viewpoint read_viewpoint(const std::string& text);

enum class Background : std::uint8_t { kDefault, kDark, kLight, kNone };
Background read_background(const std::string& text);

/// Parts to leave out of a picture, "floor,path".
struct Hidden {
  bool floor = false;
  bool ceiling = false;
  bool path = false;
  bool caption = false;
  bool nothing = false;  ///< "none": even the ceiling is drawn from above
};
Hidden read_hidden(const std::string& text);

/// Two ends; either may be open.
struct OpenRange {
  std::optional<double> least;
  std::optional<double> most;
};
/// "MIN:MAX" with the units of the colour's quantity.
OpenRange read_scale_range(const std::string& text, CloudColour colour);
/// "FROM:TO", seconds from the first pose of a log.
OpenRange read_time_range(const std::string& text);

/// The look of a cloud except floor and ceiling, which depend on the view.
CloudLook read_cloud_look(const RenderOptions& options);

/// The words allowed for --from, --background, --hide or --colour.
std::vector<std::string> option_words(std::string_view option);
std::vector<std::string> colour_map_names();
/// "height, elevation, time".
std::string listed(const std::vector<std::string>& names);

}  // namespace gdtslam
