#include "model_export.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "engine/drawing/maps/cell_number.hpp"
#include "gdtslam/core/error.hpp"
#include "gltf_file.hpp"

namespace gdtslam {
namespace {

using ModelJson = GltfJson;
using Vector3f = std::array<float, 3>;

constexpr std::size_t kBytesOfPosition = 12;
constexpr std::size_t kBytesOfColour = 8;

std::size_t path_size(const ModelInput& model) { return model.trajectory == nullptr ? 0 : model.trajectory->size(); }

Vector3f y_up(const CloudPoint& point) { return {point.x_m, point.z_m, -point.y_m}; }
Vector3f y_up(const StampedPose& pose) {
  return {static_cast<float>(pose.T_map_base.x_m), 0.0F, static_cast<float>(-pose.T_map_base.y_m)};
}

struct Box {
  Vector3f least{std::numeric_limits<float>::max(), std::numeric_limits<float>::max(),
                 std::numeric_limits<float>::max()};
  Vector3f most{std::numeric_limits<float>::lowest(), std::numeric_limits<float>::lowest(),
                std::numeric_limits<float>::lowest()};
  void add(const Vector3f& place) {
    for (std::size_t k = 0; k < place.size(); ++k) {
      least[k] = std::min(least[k], place[k]);
      most[k] = std::max(most[k], place[k]);
    }
  }
};

template <class Range>
Box box_of(const Range& points) {
  Box box;
  for (const auto& point : points) box.add(y_up(point));
  return box;
}

// The light of an sRGB value as 16 bits.
std::array<std::uint16_t, 256> linear_table() {
  std::array<std::uint16_t, 256> table{};
  for (std::size_t k = 0; k < table.size(); ++k) {
    table[k] = static_cast<std::uint16_t>(picture::linear_of(static_cast<std::uint8_t>(k)) * 65535.0 + 0.5);
  }
  return table;
}

ModelJson accessor(int view, int component, std::size_t count, const char* type) {
  return {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}};
}

ModelJson position_accessor(int view, std::size_t count, const Box& box) {
  ModelJson json = accessor(view, kGltfFloat, count, "VEC3");
  json["min"] = box.least;
  json["max"] = box.most;
  return json;
}

ModelJson buffer_view(std::size_t offset, std::size_t length) {
  return {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}, {"target", kGltfVertices}};
}

// Of one primitive. One JSON value in braces is a list to GCC and the value itself to clang; ModelJson::array is a
// list.
ModelJson mesh(const char* name, const ModelJson& primitive) {
  return {{"name", name}, {"primitives", ModelJson::array({primitive})}};
}

// All but the bytes.
ModelJson gltf_of(const ModelInput& model) {
  const std::size_t points = model.cloud.size();
  const std::size_t poses = path_size(model);
  ModelJson json = gltf_document(model.name);
  json["scenes"][0]["nodes"].push_back(0);
  json["nodes"].push_back({{"name", "cloud"}, {"mesh", 0}});
  json["meshes"].push_back(
      mesh("cloud", {{"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}, {"mode", kGltfPoints}, {"material", 0}}));
  json["materials"].push_back(gltf_unlit_material("points", colour_for(0xffffff)));
  json["accessors"] = {position_accessor(0, points, box_of(model.cloud)),
                       accessor(1, kGltfUnsignedShort, points, "VEC4")};
  json["accessors"][1]["normalized"] = true;
  json["bufferViews"] = {buffer_view(0, kBytesOfPosition * points),
                         buffer_view(kBytesOfPosition * points, kBytesOfColour * points)};
  if (poses > 1) {
    json["scenes"][0]["nodes"].push_back(1);
    json["nodes"].push_back({{"name", "path"}, {"mesh", 1}});
    json["meshes"].push_back(mesh(
        "path", {{"attributes", ModelJson::object({{"POSITION", 2}})}, {"mode", kGltfLineStrip}, {"material", 1}}));
    json["materials"].push_back(gltf_unlit_material("path", model.path_colour));
    json["accessors"].push_back(position_accessor(2, poses, box_of(*model.trajectory)));
    json["bufferViews"].push_back(buffer_view((kBytesOfPosition + kBytesOfColour) * points, kBytesOfPosition * poses));
  }
  return json;
}

// The value's bytes as they lie in memory.
template <class T>
void hand_on(const GltfSink& sink, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  sink(std::as_bytes(std::span(&value, 1)));
}

void hand_on_bytes(const ModelInput& model, const GltfSink& sink) {
  static const auto table = linear_table();
  for (const CloudPoint& point : model.cloud) hand_on(sink, y_up(point));
  for (const Colour& colour : model.colours) {
    hand_on(sink, std::array<std::uint16_t, 4>{table[colour.red], table[colour.green], table[colour.blue],
                                               std::numeric_limits<std::uint16_t>::max()});
  }
  if (path_size(model) > 1) {
    for (const StampedPose& pose : *model.trajectory) hand_on(sink, y_up(pose));
  }
}

}  // namespace

void write_gltf(const std::string& path, const ModelInput& model) {
  if (model.cloud.empty()) throw InputError({path, 0}, "is not written: there are no points");
  assert(model.colours.size() == model.cloud.size());
  const std::size_t poses = path_size(model) > 1 ? path_size(model) : 0;
  const std::size_t bytes = (kBytesOfPosition + kBytesOfColour) * model.cloud.size() + kBytesOfPosition * poses;
  constexpr std::size_t kMostBytes = 0xFF000000;  // of 2^32, with room for the text
  if (bytes > kMostBytes) throw InputError({path, 0}, "is not written: glTF ends at 4 GiB; --points thins the cloud");
  write_gltf_file(path, gltf_of(model), bytes, [&model](const GltfSink& sink) { hand_on_bytes(model, sink); });
}

}  // namespace gdtslam
