// What `gdtslam measure` found in a cloud, and how it is printed: text in centimetres, JSON and CSV in metres and
// degrees. Thread-safe; O(boxes and planes).
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/cloud/box.hpp"
#include "gdtslam/cloud/plane.hpp"

namespace gdtslam {

/// Where the viewpoint comes from.
enum class ViewpointSource : std::uint8_t { kNone, kFound, kGiven };

struct Measurement {
  std::string cloud;  ///< the file
  std::uint64_t points = 0;
  std::optional<Point3> viewpoint;
  ViewpointSource viewpoint_source = ViewpointSource::kNone;
  bool has_boxes = false;  ///< boxes were asked for
  bool has_planes = false;
  bool is_projection = false;
  std::vector<MeasuredBox> boxes;
  std::vector<PlanePatch> planes;
};

/// "58.29 +- 0.02 cm".
std::string dimension_text(const Dimension& dimension);
std::string as_text(const Measurement& measured);
nlohmann::ordered_json as_json(const Measurement& measured);
/// One heading with units and one row for each box; for each plane where no boxes were asked for.
std::string as_csv(const Measurement& measured);

}  // namespace gdtslam
