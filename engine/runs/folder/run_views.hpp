// The views of a run that need no OpenGL, as `gdtslam render` draws them. Frame: map, y up. Thread-safe; O(cells +
// pixels + poses).
#pragma once

#include <optional>
#include <string>

#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/image.hpp"

namespace gdtslam {

/// A view of a run, and its looks.
struct RunViewRequest {
  std::string view = "map";            ///< map, graph, field or distance
  std::optional<PictureSize> size{};   ///< a size that suits the content when empty
  std::optional<std::string> title{};  ///< the log's name when empty
  std::string colour_map{};            ///< colours of the field; the view's own when empty
};

/// Throws UsageError for an unknown view or an impossible size; InputError if the run lacks data for the view;
/// ConfigError for an unknown colour map; FileError.
Canvas run_view(const RunReader& run, const RunViewRequest& request);

/// The drawing as the bytes of a file: "svg", and with Cairo in this build "png" and "pdf". Throws UsageError,
/// UnavailableError.
std::string picture_bytes(const Canvas& drawing, const std::string& format);

}  // namespace gdtslam
