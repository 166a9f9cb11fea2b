#include "gdtslam/viewer/page.hpp"

#include <array>
#include <string_view>
#include <utility>

#include "engine/drawing/markup.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "page_cloud.hpp"
#include "page_layers.hpp"

/// The files of viewer/page as they were when the program was built.
namespace gdtslam::page_text {
std::string_view skeleton();  ///< page.html with {{name}} where page_of fills in
std::string_view style();
std::string_view program();       ///< all scripts, one after the other
std::string_view program_hash();  ///< of that, for the content security policy
}  // namespace gdtslam::page_text

namespace gdtslam {
namespace {

/// The palette of all our pictures as properties of the page's style.
std::string palette() {
  const std::array<std::pair<std::string_view, Colour>, 14> colours{{{"page", ink::kPage},
                                                                     {"card", ink::kCard},
                                                                     {"edge", ink::kEdge},
                                                                     {"text", ink::kText},
                                                                     {"quiet", ink::kQuiet},
                                                                     {"grid", ink::kGrid},
                                                                     {"crank", ink::kCrank},
                                                                     {"coupler", ink::kCoupler},
                                                                     {"rocker", ink::kRocker},
                                                                     {"ground", ink::kGround},
                                                                     {"curve", ink::kCurve},
                                                                     {"laser", ink::kLaser},
                                                                     {"laser-text", ink::kLaserText},
                                                                     {"night", ink::kNight}}};
  std::string out = ":root {";
  for (const auto& [name, colour] : colours) {
    out.append(" --").append(name).append(": ").append(hex_text(colour)).append(";");
  }
  return out + " }\n";
}

/// What a page holds beside the program: one JSON text, and elements with bytes.
struct PageData {
  std::string description;
  std::string elements;
};

PageData data_of(const PageInput& input) {
  PageData data;
  page::JsonWriter json;
  json.open("", '{').number("version", 1).text("title", input.title).text("subtitle", input.subtitle);
  json.open("facts", '[');
  for (const auto& [name, value] : input.facts) json.open("", '[').text("", name).text("", value).close();
  json.close();
  Point3 origin(0.0, 0.0, 0.0);
  if (input.cloud != nullptr && !input.cloud->empty()) {
    const page::PagedCloud cloud(*input.cloud, input.distances_m);
    data.elements.reserve(16 * cloud.count() + (std::size_t{1} << 21U));
    origin = cloud.least();
    cloud.describe(json);
    cloud.append_points(data.elements);
  } else if (input.map != nullptr) {
    origin = {input.map->geometry.origin_x_m, input.map->geometry.origin_y_m, 0.0};
  } else if (input.trajectory != nullptr && !input.trajectory->empty() &&
             input.trajectory->front().T_map_base.is_finite()) {
    origin.head<2>() = input.trajectory->front().T_map_base.translation();
  }
  json.point("origin", origin);
  if (input.trajectory != nullptr) page::write_path(*input.trajectory, input.drives, origin, json, data.elements);
  if (input.map != nullptr) page::write_map(*input.map, json, data.elements);
  if (input.linkage != nullptr) page::write_linkage(*input.linkage, json, data.elements);
  page::write_colour_maps(json);
  data.description = json.close().str();
  return data;
}

/// Titles and facts are anybody's: only the page's own script runs, and it can fetch nothing and send nothing.
std::string policy() {
  return "default-src 'none'; script-src " + std::string(page_text::program_hash()) +
         "; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'";
}

/// The skeleton with each {{name}} replaced; what is put in is never looked at again.
std::string filled(std::string_view skeleton, const PageInput& input, const PageData& data) {
  std::string out;
  out.reserve(data.elements.size() + data.description.size() + (std::size_t{1} << 18U));
  while (true) {
    const std::size_t open = skeleton.find("{{");
    out += skeleton.substr(0, open);
    if (open == std::string_view::npos) return out;
    const std::size_t close = skeleton.find("}}", open);
    const std::string_view name = skeleton.substr(open + 2, close - open - 2);
    if (name == "title") out += markup_text(input.title);
    if (name == "style") out.append(palette()).append(page_text::style());
    if (name == "data") out += data.description;
    if (name == "elements") out += data.elements;
    if (name == "policy") out += policy();
    if (name == "program") out += page_text::program();
    skeleton.remove_prefix(close + 2);
  }
}

}  // namespace

std::string page_of(const PageInput& input) {
  const bool has_cloud = input.cloud != nullptr && !input.cloud->empty();
  const bool has_path = input.trajectory != nullptr && !input.trajectory->empty();
  const bool has_map = input.map != nullptr && input.map->geometry.cell_count() > 0;
  if (!has_cloud && !has_path && !has_map && input.linkage == nullptr) {
    throw InputError("there is nothing to show: a page needs a cloud, a path, a map or a linkage");
  }
  return filled(page_text::skeleton(), input, data_of(input));
}

}  // namespace gdtslam
