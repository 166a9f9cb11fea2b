#include "page_messages.hpp"

#include <zlib.h>

#include <cmath>
#include <new>

#include "engine/drawing/letters.hpp"
#include "engine/drawing/page/page_writer.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

using page::Json;

// Valid points as they were matched, each seen from the robot's pose at its time.
Json points_description(const ShownScan& shown) {
  Json points = Json::array();
  if (!shown.T_map_base) return points;
  for (const Point2& point_base_m : to_points(shown.laser, shown.valid)) {
    const Point2 point_m = *shown.T_map_base * point_base_m;
    points.push_back(std::llround(100.0 * point_m.x()));
    points.push_back(std::llround(100.0 * point_m.y()));
  }
  return points;
}

std::string compressed(const std::string& text) {
  uLongf size = ::compressBound(text.size());
  std::string out(size, '\0');
  const int status = ::compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                                 reinterpret_cast<const Bytef*>(text.data()), text.size(), Z_BEST_SPEED);
  if (status != Z_OK) throw std::bad_alloc();
  out.resize(size);
  return out;
}

}  // namespace

std::string live_page_text(const PageDrive& drive, const std::string& title) {
  page::PageData data;
  data.description = {{"title", legible(title)}, {"subtitle", ""},     {"facts", Json::array()}, {"live", true},
                      {"drive", drive.name},     {"origin", {0, 0, 0}}};
  return page::page_text(data, "img-src data: blob:; connect-src 'self'");
}

std::string scan_message(const PageDrive& drive, const ShownScan* scan) {
  Json message{{"drive", drive.name}, {"origin", {drive.origin_m.x(), drive.origin_m.y(), 0.0}}, {"map", drive.map}};
  if (scan == nullptr) return page::json_text(message);
  message["scan"] = scan->scan;
  message["pose"] = nullptr;
  if (const auto& T = scan->T_map_base) message["pose"] = {T->x_m, T->y_m, T->theta_rad};
  message["inDoubt"] = scan->is_in_doubt;
  for (const auto& [name, value] : scan->figures()) message["figures"][name] = value;
  message["points"] = points_description(*scan);
  return page::json_text(message);
}

std::string map_message(const PageDrive& drive, const OccupancyMap& map, const Trajectory& path) {
  page::PageData data;
  page::write_map(map, data);
  page::write_path(path, {}, drive.origin_m, data);
  data.description["scans"] = path.size();
  for (const auto& [id, text] : data.elements) data.description["elements"][id] = text;
  return compressed(page::json_text(data.description));
}

}  // namespace gdtslam
