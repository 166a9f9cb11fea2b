// Boxes and planes in a cloud, for `gdtslam evaluate --boxes` and `--planes`: the search, and its results as text and
// tables, boxes in centimetres, all else in metres and degrees. Thread-safe; O(boxes and planes), measure_cloud() as
// the searches.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/cloud/measured_plane.hpp"
#include "gdtslam/cloud/plane.hpp"
#include "gdtslam/core/cloud.hpp"

namespace gdtslam {

/// Source of the viewpoint.
enum class ViewpointSource : std::uint8_t { kNone, kFound, kGiven };

struct Measurement {
  std::string cloud;  ///< the file
  std::uint64_t points = 0;
  std::optional<Point3> viewpoint;
  ViewpointSource viewpoint_source = ViewpointSource::kNone;
  bool has_boxes = false;  ///< boxes were requested
  bool has_planes = false;
  bool is_projection = false;
  std::vector<MeasuredBox> boxes;
  std::vector<MeasuredPlane> planes;  ///< the largest first
};

/// "58.29 +- 0.02 cm".
std::string dimension_text(const Dimension& dimension);
std::string as_text(const Measurement& measured);
nlohmann::ordered_json as_json(const Measurement& measured);
/// One heading with units and one row for each box; without boxes one for each plane.
std::string as_csv(const Measurement& measured);

struct MeasureJob {
  std::string cloud;  ///< the file, for the record
  bool boxes = false;
  bool planes = false;
  BoxSearch box_search{};  ///< without the viewpoint
  PlaneSearch plane_search{};
  bool finds_viewpoint = true;        ///< searches for one if none is given
  std::optional<Point3> viewpoint{};  ///< given viewpoint, in the coordinates of the file
  /// Offset subtracted from the coordinates of the file (read_cloud()); all measured places are relative to it.
  std::array<double, 3> origin_m{};
};

/// Measures as `gdtslam evaluate --boxes` does: finds the viewpoint unless it is given, then boxes and planes.
Measurement measure_cloud(const MeasureJob& job, std::span<const CloudPoint> cloud);

}  // namespace gdtslam
