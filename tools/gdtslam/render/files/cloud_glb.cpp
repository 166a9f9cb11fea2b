#include <array>
#include <cassert>
#include <cstdint>
#include <limits>

#include "gdtslam/core/error.hpp"
#include "glb.hpp"
#include "glb_document.hpp"

namespace gdtslam {
namespace {

// The light of an sRGB value as 16 bits.
std::array<std::uint16_t, 256> linear_table() {
  std::array<std::uint16_t, 256> table{};
  for (std::size_t k = 0; k < table.size(); ++k) {
    table[k] = static_cast<std::uint16_t>(linear_light(static_cast<std::uint8_t>(k)) * 65535.0 + 0.5);
  }
  return table;
}

void add_node(GltfJson& json, const char* name, const GltfJson& primitive) {
  json["scenes"][0]["nodes"].push_back(json["nodes"].size());
  json["nodes"].push_back({{"name", name}, {"mesh", json["meshes"].size()}});
  // One JSON value in braces is a list to GCC and the value itself to clang; GltfJson::array is a list.
  json["meshes"].push_back({{"name", name}, {"primitives", GltfJson::array({primitive})}});
}

}  // namespace

void write_cloud_glb(const std::string& path, const CloudModel& model) {
  if (model.cloud.empty()) throw InputError({path, 0}, "is not written: there are no points");
  assert(model.colours.size() == model.cloud.size());
  GlbDocument document(model.name);
  GltfJson& json = document.json();
  std::vector<std::array<float, 3>> places;
  for (const CloudPoint& point : model.cloud) places.push_back({point.x_m, point.z_m, -point.y_m});
  const auto table = linear_table();
  std::vector<std::array<std::uint16_t, 4>> colours;
  for (const Colour& colour : model.colours) {
    colours.push_back(
        {table[colour.red], table[colour.green], table[colour.blue], std::numeric_limits<std::uint16_t>::max()});
  }
  const std::size_t positions = document.add_places(places);
  const std::size_t lights = document.add_accessor(colours, kGltfUnsignedShort, "VEC4");
  json["accessors"][lights]["normalized"] = true;
  json["materials"].push_back(gltf_unlit_material("points", colour_for(0xffffff)));
  add_node(json, "cloud",
           {{"attributes", {{"POSITION", positions}, {"COLOR_0", lights}}}, {"mode", kGltfPoints}, {"material", 0}});
  if (model.trajectory != nullptr && model.trajectory->size() > 1) {
    places.clear();
    for (const StampedPose& pose : *model.trajectory) {
      places.push_back({static_cast<float>(pose.T_map_base.x_m), 0.0F, static_cast<float>(-pose.T_map_base.y_m)});
    }
    json["materials"].push_back(gltf_unlit_material("path", ink::kCrank));
    add_node(json, "path",
             {{"attributes", GltfJson::object({{"POSITION", document.add_places(places)}})},
              {"mode", kGltfLineStrip},
              {"material", 1}});
  }
  document.write(path);
}

}  // namespace gdtslam
