// A glTF 2.0 document [Khronos2021] of one buffer, as a binary file (.glb): text and bytes one after the other, which
// needs no other file. One object belongs to one thread; memory: the bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {

using GltfJson = nlohmann::ordered_json;

// Element types and modes, sections 3.6.2.2 and 3.7.2.1.
inline constexpr int kGltfUnsignedShort = 5123;
inline constexpr int kGltfUnsignedInt = 5125;
inline constexpr int kGltfFloat = 5126;
inline constexpr int kGltfPoints = 0;
inline constexpr int kGltfLineStrip = 3;

/// Light, 0 to 1, of a channel of sRGB (IEC 61966-2-1), as glTF counts.
double linear_light(std::uint8_t channel);
/// A material that has its colour in any light.
GltfJson gltf_unlit_material(const std::string& name, Colour colour);

class GlbDocument {
 public:
  /// A document with one scene of that name, without nodes yet.
  explicit GlbDocument(const std::string& name);
  [[nodiscard]] GltfJson& json() { return json_; }
  /// Index of a new accessor of these values, whose size is a multiple of 4 bytes.
  template <class Value>
  std::size_t add_accessor(const std::vector<Value>& values, int component, const char* type) {
    static_assert(sizeof(Value) % 4 == 0);
    return add_bytes(std::as_bytes(std::span(values)), values.size(), component, type);
  }
  /// An accessor of places, with the bounds that the format wants.
  std::size_t add_places(const std::vector<std::array<float, 3>>& places);
  /// Throws FileError; InputError beyond 4 GiB, where a .glb ends.
  void write(const std::string& path);

 private:
  std::size_t add_bytes(std::span<const std::byte> bytes, std::size_t count, int component, const char* type);

  GltfJson json_;
  std::vector<std::byte> bytes_;
};

}  // namespace gdtslam
