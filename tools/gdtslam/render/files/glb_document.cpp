#include "glb_document.hpp"

#include <algorithm>
#include <bit>

#include "engine/core/elementary.hpp"
#include "engine/io/atomic_file.hpp"
#include "gdtslam/core/error.hpp"

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
constexpr std::size_t kMostBytes = 0xFF000000;  // of 2^32, with room for the text

void write_numbers(AtomicFile& file, std::span<const std::uint32_t> numbers) { file.write(std::as_bytes(numbers)); }

}  // namespace

double linear_light(std::uint8_t channel) {
  const double value = channel / 255.0;
  return value <= 0.04045 ? value / 12.92 : gdtslam::exp(2.4 * gdtslam::log((value + 0.055) / 1.055));
}

GltfJson gltf_unlit_material(const std::string& name, Colour colour) {
  return {{"name", name},
          {"pbrMetallicRoughness",
           {{"baseColorFactor", {linear_light(colour.red), linear_light(colour.green), linear_light(colour.blue), 1.0}},
            {"metallicFactor", 0},
            {"roughnessFactor", 1}}},
          {"extensions", GltfJson::object({{"KHR_materials_unlit", GltfJson::object()}})}};
}

GlbDocument::GlbDocument(const std::string& name) {
  json_["asset"] = {{"version", "2.0"}, {"generator", "gdtslam " GDTSLAM_VERSION}};
  json_["extensionsUsed"] = GltfJson::array({"KHR_materials_unlit"});
  json_["scene"] = 0;
  json_["scenes"].push_back({{"name", name}, {"nodes", GltfJson::array()}});
  // All of them now: a new key moves the others, and with them what a reference to one of them refers to.
  for (const char* key : {"nodes", "meshes", "materials", "accessors", "bufferViews"}) json_[key] = GltfJson::array();
}

std::size_t GlbDocument::add_bytes(std::span<const std::byte> bytes, std::size_t count, int component,
                                   const char* type) {
  json_["accessors"].push_back(
      {{"bufferView", json_["bufferViews"].size()}, {"componentType", component}, {"count", count}, {"type", type}});
  json_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}});
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  return json_["accessors"].size() - 1;
}

std::size_t GlbDocument::add_places(const std::vector<std::array<float, 3>>& places) {
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

void GlbDocument::write(const std::string& path) {
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

}  // namespace gdtslam
