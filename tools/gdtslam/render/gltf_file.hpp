// glTF 2.0 files [Khronos2021] of one buffer: as text with the bytes in base64 (.gltf), or as text and bytes one after
// the other (.glb). Either is one file that needs nothing else, written to a temporary name, synced and renamed; memory
// does not depend on the number of bytes. Thread-safe apart from the file.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {

using GltfJson = nlohmann::ordered_json;

// Element types, modes and targets, sections 3.6.2.2, 3.7.2.1 and 5.11.5.
inline constexpr int kGltfUnsignedShort = 5123;
inline constexpr int kGltfUnsignedInt = 5125;
inline constexpr int kGltfFloat = 5126;
inline constexpr int kGltfVertices = 34962;
inline constexpr int kGltfIndices = 34963;
inline constexpr int kGltfPoints = 0;
inline constexpr int kGltfLineStrip = 3;

/// "asset", and one scene of that name without nodes yet.
GltfJson gltf_document(const std::string& name);
/// Linear light, 0 to 1, of an sRGB colour, as glTF counts.
std::array<double, 3> linear_light(Colour colour);
/// What has its colour whatever the light.
GltfJson gltf_unlit_material(const std::string& name, Colour colour);

/// Hands on the bytes of the buffer, piece by piece.
using GltfSink = std::function<void(std::span<const std::byte>)>;
using GltfBytes = std::function<void(const GltfSink&)>;
/// The document with a buffer of `count` bytes, a multiple of 4, behind it; as .glb where the path ends so. Throws
/// FileError.
void write_gltf_file(const std::string& path, GltfJson document, std::size_t count, const GltfBytes& bytes);

}  // namespace gdtslam
