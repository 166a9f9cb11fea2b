// A linkage as .glb: its parts, and the turn of the crank as an animation.
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "glb.hpp"
#include "glb_document.hpp"

namespace gdtslam {
namespace {

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
    // The document's y is up, the linkage's z.
    json_["nodes"].push_back(
        {{"name", "linkage"}, {"rotation", {-kHalf, 0.0, 0.0, kHalf}}, {"children", GltfJson::array()}});
    json_["scenes"][0]["nodes"].push_back(0);
  }

  void add(const SolidPart& part) {
    const std::size_t node = json_["nodes"].size();
    GltfJson primitives = GltfJson::array();
    for (const Solid& solid : part.solids) {
      if (!solid.triangles.empty()) primitives.push_back(primitive_of(solid));
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
  GltfJson primitive_of(const Solid& solid) {
    const std::size_t places = document_.add_places(solid.places);
    const std::size_t normals = document_.add_accessor(solid.normals, kGltfFloat, "VEC3");
    std::vector<std::uint32_t> corners;
    for (const auto& triangle : solid.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
    const std::size_t indices = document_.add_accessor(corners, kGltfUnsignedInt, "SCALAR");
    return {{"attributes", {{"POSITION", places}, {"NORMAL", normals}}},
            {"indices", indices},
            {"material", material_of(solid)}};
  }

  /// One for all solids of a look.
  std::size_t material_of(const Solid& solid) {
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
    if (!times_) times_ = times_of(part.poses.size());
    std::vector<Vector3f> places;
    std::vector<Vector4f> rotations;
    for (const Pose3& pose : part.poses) {
      places.push_back(place_of_pose(pose));
      rotations.push_back(rotation_of_pose(pose));
      // Of the two quaternions of a rotation the one near the last, so that the part turns the short way.
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

  std::size_t times_of(std::size_t count) {
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

void write_linkage_glb(const std::string& path, const std::string& name, const std::vector<SolidPart>& parts,
                       double turn_s) {
  LinkageDocument document(name, turn_s);
  for (const SolidPart& part : parts) document.add(part);
  document.write(path);
}

}  // namespace gdtslam
