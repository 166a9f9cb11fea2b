#include "gdtslam/viewer/page.hpp"

#include <utility>

#include "engine/core/base64.hpp"
#include "engine/drawing/letters.hpp"
#include "engine/drawing/page/page_layers.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "page_cloud.hpp"
#include "viewer/scene/cloud/cloud_colours.hpp"

namespace gdtslam {
namespace {

using page::Json;

/// Name and 256 colours of each map.
Json colour_maps_description() {
  Json maps = Json::array();
  for (const ColourMap& map : colour_maps()) {
    std::vector<std::uint8_t> bytes;
    for (const Colour& colour : map.table()) bytes.insert(bytes.end(), {colour.red, colour.green, colour.blue});
    std::string colours;
    append_base64(std::as_bytes(std::span(bytes)), colours);
    maps.push_back({{"name", map.name()}, {"doc", map.doc()}, {"colours", colours}});
  }
  return maps;
}

/// The colour map that suits each quantity on a dark and on a light ground, as in pictures of a cloud.
Json default_maps() {
  const std::pair<const char*, CloudColour> quantities[] = {{"height", CloudColour::kHeight},
                                                            {"elevation", CloudColour::kElevation},
                                                            {"time", CloudColour::kTime},
                                                            {"scan", CloudColour::kScan},
                                                            {"distance", CloudColour::kDistance}};
  Json maps;
  for (const bool is_dark : {true, false}) {
    for (const auto& [key, colour] : quantities) {
      CloudLook look;
      look.colour = colour;
      look.is_dark = is_dark;
      maps[is_dark ? "dark" : "light"][key] = colour_scale(look, CloudValues(colour, {}, {}), {}).colour_map;
    }
  }
  return maps;
}

page::PageData data_of(const PageInput& input) {
  page::PageData data;
  Json& about = data.description;
  about["title"] = legible(input.title);
  about["subtitle"] = legible(input.subtitle);
  about["facts"] = Json::array();
  for (const auto& [name, value] : input.facts) about["facts"].push_back({legible(name), legible(value)});
  Point3 origin(0.0, 0.0, 0.0);
  if (input.cloud != nullptr && !input.cloud->empty()) {
    const page::PagedCloud cloud(*input.cloud, input.distances_m);
    origin = cloud.least();
    about["cloud"] = cloud.description();
    cloud.add_points(data);
    about["colour_maps"] = colour_maps_description();
    about["default_maps"] = default_maps();
  } else if (input.map != nullptr) {
    origin = {input.map->geometry.origin_x_m, input.map->geometry.origin_y_m, 0.0};
  } else if (input.trajectory != nullptr && !input.trajectory->empty() &&
             input.trajectory->front().T_map_base.is_finite()) {
    origin.head<2>() = input.trajectory->front().T_map_base.translation();
  }
  about["origin"] = {origin.x(), origin.y(), origin.z()};
  if (input.trajectory != nullptr) page::write_path(*input.trajectory, input.drives, origin.head<2>(), data);
  if (input.map != nullptr) page::write_map(*input.map, data);
  if (input.linkage != nullptr) page::write_linkage(*input.linkage, data);
  return data;
}

}  // namespace

std::string page_of(const PageInput& input) {
  const bool has_cloud = input.cloud != nullptr && !input.cloud->empty();
  const bool has_path = input.trajectory != nullptr && !input.trajectory->empty();
  const bool has_map = input.map != nullptr && input.map->geometry.cell_count() > 0;
  if (!has_cloud && !has_path && !has_map && input.linkage == nullptr) {
    throw InputError("there is nothing to show: a page needs a cloud, a path, a map or a linkage");
  }
  return page::page_text(data_of(input), "img-src data: blob:");
}

}  // namespace gdtslam
