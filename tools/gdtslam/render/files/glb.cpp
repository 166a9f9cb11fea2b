// glTF 2.0 documents [Khronos2021] as binary files: clouds, and linkages with the turn of the crank as an animation.
#include "glb.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/core/elementary.hpp"
#include "engine/io/atomic_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {
namespace {

static_assert(std::endian::native == std::endian::little, "the format wants little-endian numbers");

// Section 4.4.
constexpr std::uint32_t kMagic = 0x46546C67;
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kTextChunk = 0x4E4F534A;
constexpr std::uint32_t kBytesChunk = 0x004E4942;
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;
constexpr std::size_t kMostBytes = 0xFF000000;  // slightly below 2^32, with room for the text

void write_numbers(AtomicFile& file, std::span<const std::uint32_t> numbers) { file.write(std::as_bytes(numbers)); }

using GltfJson = nlohmann::ordered_json;

// Element types and modes, sections 3.6.2.2 and 3.7.2.1.
constexpr int kGltfUnsignedShort = 5123;
constexpr int kGltfUnsignedInt = 5125;
constexpr int kGltfFloat = 5126;
constexpr int kGltfPoints = 0;
constexpr int kGltfLineStrip = 3;

/// A document with one buffer: text and bytes in one file. Memory: the bytes.
class GlbDocument {
 public:
  /// Starts a document with one empty scene of that name.
  explicit GlbDocument(const std::string& name) {
    json_["asset"] = {{"version", "2.0"}, {"generator", "gdtslam " GDTSLAM_VERSION}};
    json_["extensionsUsed"] = GltfJson::array({"KHR_materials_unlit"});
    json_["scene"] = 0;
    json_["scenes"].push_back({{"name", name}, {"nodes", GltfJson::array()}});
    // All keys are added now, because a new key moves the others and invalidates references to them.
    for (const char* key : {"nodes", "meshes", "materials", "accessors", "bufferViews"}) json_[key] = GltfJson::array();
  }
  [[nodiscard]] GltfJson& json() { return json_; }
  /// Adds an accessor of these values, whose size is a multiple of 4 bytes; returns its index.
  template <class Value>
  std::size_t add_accessor(const std::vector<Value>& values, int component, const char* type) {
    static_assert(sizeof(Value) % 4 == 0);
    return add_bytes(std::as_bytes(std::span(values)), values.size(), component, type);
  }

  /// Adds an accessor of positions, with the bounds that the format requires.
  std::size_t add_places(const std::vector<std::array<float, 3>>& places) {
    std::array<float, 3> least = places.front();
    std::array<float, 3> most = least;
    for (const std::array<float, 3>& place : places) {
      for (std::size_t axis = 0; axis < place.size(); ++axis) {
        least[axis] = std::min(least[axis], place[axis]);
        most[axis] = std::max(most[axis], place[axis]);
      }
    }
    const std::size_t accessor = add_accessor(places, kGltfFloat, "VEC3");
    json_["accessors"][accessor]["min"] = least;
    json_["accessors"][accessor]["max"] = most;
    return accessor;
  }
  /// Throws FileError; InputError beyond 4 GiB, the limit of a .glb.
  void write(const std::string& path) {
    if (bytes_.size() > kMostBytes) {
      throw InputError({path, 0}, "is not written: a .glb ends at 4 GiB; --points thins the cloud");
    }
    json_["buffers"] = GltfJson::array({GltfJson::object({{"byteLength", bytes_.size()}})});
    std::string text = json_.dump(-1, ' ', true, GltfJson::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    AtomicFile file(path);
    const std::size_t whole = kHeaderBytes + 2 * kChunkHeaderBytes + text.size() + bytes_.size();
    write_numbers(file, std::array{kMagic, kVersion, static_cast<std::uint32_t>(whole),
                                   static_cast<std::uint32_t>(text.size()), kTextChunk});
    file.write(text);
    write_numbers(file, std::array{static_cast<std::uint32_t>(bytes_.size()), kBytesChunk});
    file.write(std::span<const std::byte>(bytes_));
    file.commit();
  }

 private:
  std::size_t add_bytes(std::span<const std::byte> bytes, std::size_t count, int component, const char* type) {
    json_["accessors"].push_back(
        {{"bufferView", json_["bufferViews"].size()}, {"componentType", component}, {"count", count}, {"type", type}});
    json_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}});
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return json_["accessors"].size() - 1;
  }

  GltfJson json_;
  std::vector<std::byte> bytes_;
};

/// Linear light, 0 to 1, of an sRGB channel (IEC 61966-2-1), as in glTF.
double linear_light(std::uint8_t channel) {
  const double value = channel / 255.0;
  return value <= 0.04045 ? value / 12.92 : gdtslam::exp(2.4 * gdtslam::log((value + 0.055) / 1.055));
}

/// A material that looks the same in any light.
GltfJson gltf_unlit_material(const std::string& name, Colour colour) {
  return {{"name", name},
          {"pbrMetallicRoughness",
           {{"baseColorFactor", {linear_light(colour.red), linear_light(colour.green), linear_light(colour.blue), 1.0}},
            {"metallicFactor", 0},
            {"roughnessFactor", 1}}},
          {"extensions", GltfJson::object({{"KHR_materials_unlit", GltfJson::object()}})}};
}

// Linear light of each sRGB value in 16 bits.
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
  // GCC reads one JSON value in braces as a list, clang as the value itself; GltfJson::array is always a list.
  json["meshes"].push_back({{"name", name}, {"primitives", GltfJson::array({primitive})}});
}

using Vector3f = std::array<float, 3>;
using Vector4f = std::array<float, 4>;

Vector3f place_of_pose(const Pose3& pose) {
  return {static_cast<float>(pose.translation_m.x()), static_cast<float>(pose.translation_m.y()),
          static_cast<float>(pose.translation_m.z())};
}

Vector4f rotation_of_pose(const Pose3& pose) {
  const Eigen::Vector4d xyzw = pose.rotation.coeffs();
  return {static_cast<float>(xyzw[0]), static_cast<float>(xyzw[1]), static_cast<float>(xyzw[2]),
          static_cast<float>(xyzw[3])};
}

class LinkageDocument {
 public:
  LinkageDocument(const std::string& name, double turn_s) : document_(name), json_(document_.json()), turn_s_(turn_s) {
    constexpr double kHalf = 0.7071067811865476;
    // The document's y axis is up, the linkage's z axis.
    json_["nodes"].push_back(
        {{"name", "linkage"}, {"rotation", {-kHalf, 0.0, 0.0, kHalf}}, {"children", GltfJson::array()}});
    json_["scenes"][0]["nodes"].push_back(0);
  }

  void add(const SolidPart& part) {
    const std::size_t node = json_["nodes"].size();
    GltfJson primitives = GltfJson::array();
    for (const Solid& solid : part.solids) {
      if (!solid.triangles.empty()) primitives.push_back(make_primitive(solid));
    }
    json_["nodes"][0]["children"].push_back(node);
    json_["nodes"].push_back({{"name", part.name},
                              {"mesh", json_["meshes"].size()},
                              {"translation", place_of_pose(part.shown)},
                              {"rotation", rotation_of_pose(part.shown)}});
    json_["meshes"].push_back({{"name", part.name}, {"primitives", std::move(primitives)}});
    animate(part, node);
  }

  void write(const std::string& path) {
    if (!channels_.empty()) {
      json_["animations"].push_back({{"name", "one turn"}, {"channels", channels_}, {"samplers", samplers_}});
    }
    document_.write(path);
  }

 private:
  GltfJson make_primitive(const Solid& solid) {
    const std::size_t places = document_.add_places(solid.places);
    const std::size_t normals = document_.add_accessor(solid.normals, kGltfFloat, "VEC3");
    std::vector<std::uint32_t> corners;
    for (const auto& triangle : solid.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
    const std::size_t indices = document_.add_accessor(corners, kGltfUnsignedInt, "SCALAR");
    return {{"attributes", {{"POSITION", places}, {"NORMAL", normals}}},
            {"indices", indices},
            {"material", find_material(solid)}};
  }

  /// One material for all solids of the same look.
  std::size_t find_material(const Solid& solid) {
    const auto key = std::tuple(hex_text(solid.colour), solid.opacity, solid.is_lit);
    const auto [found, is_new] = materials_.try_emplace(key, materials_.size());
    if (!is_new) return found->second;
    GltfJson material = gltf_unlit_material(hex_text(solid.colour), solid.colour);
    if (solid.is_lit) {
      constexpr double kRoughness = 0.6;
      material.erase("extensions");
      material["pbrMetallicRoughness"]["roughnessFactor"] = kRoughness;
    } else {
      material["doubleSided"] = true;  // the fan is seen from both sides
    }
    if (solid.opacity < 1.0) {
      material["alphaMode"] = "BLEND";
      material["pbrMetallicRoughness"]["baseColorFactor"][3] = solid.opacity;
    }
    json_["materials"].push_back(std::move(material));
    return found->second;
  }

  void animate(const SolidPart& part, std::size_t node) {
    const bool is_still = std::all_of(part.poses.begin(), part.poses.end(),
                                      [&part](const Pose3& pose) { return pose == part.poses.front(); });
    if (is_still) return;
    if (!times_) times_ = add_times(part.poses.size());
    std::vector<Vector3f> places;
    std::vector<Vector4f> rotations;
    for (const Pose3& pose : part.poses) {
      places.push_back(place_of_pose(pose));
      rotations.push_back(rotation_of_pose(pose));
      // A rotation has two quaternions; the one nearer to the last makes the part turn the short way.
      if (rotations.size() < 2) continue;
      const Vector4f& before = rotations[rotations.size() - 2];
      Vector4f& now = rotations.back();
      float along = 0.0F;
      for (std::size_t k = 0; k < now.size(); ++k) along += before[k] * now[k];
      if (along < 0.0F) std::transform(now.begin(), now.end(), now.begin(), [](float value) { return -value; });
    }
    add_channel(node, "translation", document_.add_accessor(places, kGltfFloat, "VEC3"));
    add_channel(node, "rotation", document_.add_accessor(rotations, kGltfFloat, "VEC4"));
  }

  std::size_t add_times(std::size_t count) {
    std::vector<float> times_s;
    for (std::size_t k = 0; k < count; ++k) {
      times_s.push_back(static_cast<float>(turn_s_ * static_cast<double>(k) / static_cast<double>(count - 1)));
    }
    const std::size_t accessor = document_.add_accessor(times_s, kGltfFloat, "SCALAR");
    json_["accessors"][accessor]["min"] = {times_s.front()};
    json_["accessors"][accessor]["max"] = {times_s.back()};
    return accessor;
  }

  void add_channel(std::size_t node, const char* path, std::size_t values) {
    channels_.push_back(
        {{"sampler", samplers_.size()}, {"target", GltfJson::object({{"node", node}, {"path", path}})}});
    samplers_.push_back({{"input", *times_}, {"output", values}, {"interpolation", "LINEAR"}});
  }

  GlbDocument document_;
  GltfJson& json_;
  double turn_s_;
  std::map<std::tuple<std::string, double, bool>, std::size_t> materials_;
  std::optional<std::size_t> times_;
  GltfJson channels_ = GltfJson::array();
  GltfJson samplers_ = GltfJson::array();
};

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

void write_linkage_glb(const std::string& path, const std::string& name, const std::vector<SolidPart>& parts,
                       double turn_s) {
  LinkageDocument document(name, turn_s);
  for (const SolidPart& part : parts) document.add(part);
  document.write(path);
}

}  // namespace gdtslam
