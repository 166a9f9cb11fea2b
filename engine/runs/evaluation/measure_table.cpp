#include "measure_table.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string_view>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

bool is_known(const Dimension& dimension) { return std::isfinite(dimension.sigma_m); }

std::string_view ends_text(const Dimension& dimension) {
  if (!is_known(dimension)) return "not seen";
  return dimension.is_observed ? "both ends seen" : "an end not seen";
}

// With that number of decimals; a value that rounds to zero has no sign.
std::string fixed(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string point_text(const Point3& point) {
  return fmt::format("{}, {}, {} m", fixed(point.x(), 3), fixed(point.y(), 3), fixed(point.z(), 3));
}

std::string viewpoint_text(const Measurement& measured) {
  switch (measured.viewpoint_source) {
    case ViewpointSource::kFound:
      return "seen from " + point_text(*measured.viewpoint) + ", found from the elevations";
    case ViewpointSource::kGiven:
      return "seen from " + point_text(*measured.viewpoint);
    case ViewpointSource::kNone:
      break;
  }
  return "no viewpoint: the ends of faces are where their points end";
}

std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string text_of_boxes(const Measurement& measured) {
  std::string text = counted(measured.boxes.size(), "box", "boxes") + (measured.boxes.empty() ? "\n" : "\n\n");
  std::size_t number = 0;
  for (const MeasuredBox& box : measured.boxes) {
    ++number;
    const auto row = [&](std::string_view label, std::string_view name, const Dimension& dimension) {
      text += fmt::format("{:<6} {:<7} {:>18}  {}\n", label, name, dimension_text(dimension), ends_text(dimension));
    };
    row(fmt::format("box {}", number), "width", box.width);
    row("", "depth", box.depth);
    row("", "height", box.height);
    text += fmt::format("{:<6} centre {}, width along {:.1f} deg; face: {} points, rms {:.1f} mm\n", "",
                        point_text(box.centre), deg_from_rad(box.yaw_rad), box.points, 1e3 * box.face_rms_m);
  }
  return text;
}

std::string text_of_planes(const Measurement& measured) {
  std::string text = counted(measured.planes.size(), "plane", "planes") + "\n";
  if (measured.planes.empty()) return text;
  text += fmt::format("\n{:<16}{:>9}  {:>15}  {:<22}{:>20}  {:>8}  {:>10}  {:>9}  {}\n", "plane", "area", "extent",
                      "normal", "offset", "rms", "tilt error", "points", "centre");
  std::size_t number = 0;
  for (const MeasuredPlane& plane : measured.planes) {
    const PlanePatch& patch = plane.patch;
    const Point3& n = patch.plane.normal;
    text += fmt::format(
        "{:<6}{:<8}{:>8.2f} m2  {:>6.2f} x {:>4.2f} m  {:>6} {:>6} {:>6}  {:>8} +- {:.4f} m  {:.4f} m"
        "  {:>6.3f} deg  {:>9}  {}\n",
        ++number, to_string(plane.kind), plane.area_m2, plane.extent_m[0], plane.extent_m[1], fixed(n.x(), 3),
        fixed(n.y(), 3), fixed(n.z(), 3), fixed(patch.plane.offset_m, 4), patch.sigma_offset_m, patch.rms_m,
        deg_from_rad(patch.sigma_normal_rad), patch.points.size(), point_text(patch.centre));
  }
  return text;
}

// Adding zero takes the sign from a zero.
Json as_json(const Point3& point) { return {point.x() + 0.0, point.y() + 0.0, point.z() + 0.0}; }

Json as_json(const Dimension& dimension) {
  if (!is_known(dimension)) return {{"value_m", nullptr}, {"sigma_m", nullptr}, {"both_ends_seen", false}};
  return {{"value_m", dimension.value_m}, {"sigma_m", dimension.sigma_m}, {"both_ends_seen", dimension.is_observed}};
}

Json as_json(const MeasuredBox& box) {
  return {{"width", as_json(box.width)},
          {"depth", as_json(box.depth)},
          {"height", as_json(box.height)},
          {"centre_m", as_json(box.centre)},
          {"yaw_deg", deg_from_rad(box.yaw_rad)},
          {"face_normal", as_json(box.face_normal)},
          {"face_points", box.points},
          {"face_rms_m", box.face_rms_m}};
}

Json as_json(const MeasuredPlane& plane) {
  const PlanePatch& patch = plane.patch;
  return {{"kind", to_string(plane.kind)},
          {"area_m2", plane.area_m2},
          {"extent_m", plane.extent_m},
          {"normal", as_json(patch.plane.normal)},
          {"offset_m", patch.plane.offset_m + 0.0},
          {"sigma_offset_m", patch.sigma_offset_m},
          {"sigma_normal_deg", deg_from_rad(patch.sigma_normal_rad)},
          {"rms_m", patch.rms_m},
          {"points", patch.points.size()},
          {"centre_m", as_json(patch.centre)}};
}

// A number, or an empty cell if nothing was seen.
std::string csv_cells(const Dimension& dimension) {
  const int is_seen = dimension.is_observed ? 1 : 0;
  return is_known(dimension) ? fmt::format("{},{},{}", dimension.value_m, dimension.sigma_m, is_seen) : ",,0";
}

void choose_viewpoint(const MeasureJob& job, std::span<const CloudPoint> cloud, Measurement& measured) {
  if (job.viewpoint) {
    measured.viewpoint = *job.viewpoint - Point3(job.origin_m[0], job.origin_m[1], job.origin_m[2]);
    measured.viewpoint_source = ViewpointSource::kGiven;
  } else if (job.finds_viewpoint) {
    measured.viewpoint = standing_viewpoint(cloud);
    if (measured.viewpoint) measured.viewpoint_source = ViewpointSource::kFound;
  }
}

}  // namespace

std::string dimension_text(const Dimension& dimension) {
  if (!is_known(dimension)) return "-";
  return fmt::format("{:.2f} +- {:.2f} cm", 100.0 * dimension.value_m, 100.0 * dimension.sigma_m);
}

std::string as_text(const Measurement& measured) {
  std::string text = fmt::format("{} points", measured.points);
  if (measured.has_boxes) {
    text += ", " + viewpoint_text(measured) + (measured.is_projection ? "; projected to the floor" : "");
    text += "\n" + text_of_boxes(measured);
  }
  if (measured.has_planes) text += (measured.has_boxes ? "\n" : ", ") + text_of_planes(measured);
  return text;
}

Json as_json(const Measurement& measured) {
  Json json{{"cloud", measured.cloud}, {"points", measured.points}};
  if (measured.has_boxes) {
    constexpr std::string_view kSources[] = {"none", "found", "given"};
    json["viewpoint_m"] = measured.viewpoint ? as_json(*measured.viewpoint) : Json(nullptr);
    json["viewpoint_source"] = kSources[static_cast<std::size_t>(measured.viewpoint_source)];
    json["projection"] = measured.is_projection;
    json["boxes"] = Json::array();
    for (const MeasuredBox& box : measured.boxes) json["boxes"].push_back(as_json(box));
  }
  if (measured.has_planes) {
    json["planes"] = Json::array();
    for (const MeasuredPlane& plane : measured.planes) json["planes"].push_back(as_json(plane));
  }
  return json;
}

std::string as_csv(const Measurement& measured) {
  std::string text;
  if (measured.has_boxes) {
    text +=
        "box,width_m,sigma_width_m,width_seen,depth_m,sigma_depth_m,depth_seen,height_m,sigma_height_m,height_seen,"
        "centre_x_m,centre_y_m,centre_z_m,yaw_deg,face_points,face_rms_m\n";
    std::size_t number = 0;
    for (const MeasuredBox& box : measured.boxes) {
      text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", ++number, csv_cells(box.width), csv_cells(box.depth),
                          csv_cells(box.height), box.centre.x(), box.centre.y(), box.centre.z(),
                          deg_from_rad(box.yaw_rad), box.points, box.face_rms_m);
    }
    return text;
  }
  text +=
      "plane,kind,area_m2,extent_m,extent_other_m,normal_x,normal_y,normal_z,offset_m,sigma_offset_m,sigma_normal_deg,"
      "rms_m,points,centre_x_m,centre_y_m,centre_z_m\n";
  std::size_t number = 0;
  for (const MeasuredPlane& plane : measured.planes) {
    const PlanePatch& patch = plane.patch;
    const Point3 n = patch.plane.normal + Point3::Zero();
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", ++number, to_string(plane.kind),
                        plane.area_m2, plane.extent_m[0], plane.extent_m[1], n.x(), n.y(), n.z(),
                        patch.plane.offset_m + 0.0, patch.sigma_offset_m, deg_from_rad(patch.sigma_normal_rad),
                        patch.rms_m, patch.points.size(), patch.centre.x(), patch.centre.y(), patch.centre.z());
  }
  return text;
}

Measurement measure_cloud(const MeasureJob& job, std::span<const CloudPoint> cloud) {
  Measurement measured;
  measured.cloud = job.cloud;
  measured.points = cloud.size();
  measured.has_boxes = job.boxes;
  measured.has_planes = job.planes;
  measured.is_projection = job.box_search.is_projection;
  if (job.boxes) {
    choose_viewpoint(job, cloud, measured);
    BoxSearch search = job.box_search;
    search.viewpoint = measured.viewpoint;
    measured.boxes = find_boxes(cloud, search);
  }
  if (job.planes) {
    measured.planes = measured_planes(cloud, find_planes(cloud, job.plane_search), job.plane_search.gap_m);
  }
  return measured;
}

}  // namespace gdtslam
