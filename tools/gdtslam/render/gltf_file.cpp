#include "gltf_file.hpp"

#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/core/base64.hpp"
#include "engine/drawing/maps/cell_number.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/referenced_file.hpp"

namespace gdtslam {
namespace {

static_assert(std::endian::native == std::endian::little, "the format wants little-endian numbers");

// Of a .glb, section 4.4.
constexpr std::uint32_t kMagic = 0x46546C67;
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kTextChunk = 0x4E4F534A;
constexpr std::uint32_t kBytesChunk = 0x004E4942;
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;

// Bytes as base64 into a file, piece by piece.
class Base64Writer {
 public:
  /// `file` must outlive this.
  explicit Base64Writer(AtomicFile& file) : file_(file) {}

  void add(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    if (bytes_.size() >= kPiece) write(bytes_.size() / 3 * 3);
  }
  /// What is left, padded.
  void finish() { write(bytes_.size()); }

 private:
  static constexpr std::size_t kPiece = 49152;  ///< 64 KiB of text

  void write(std::size_t count) {
    text_.clear();
    append_base64(std::span(bytes_).first(count), text_);
    file_.write(text_);
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(count));
  }

  AtomicFile& file_;
  std::vector<std::byte> bytes_;  ///< not written yet
  std::string text_;
};

std::string text_of(const GltfJson& document, int indent) {
  return document.dump(indent, ' ', true, GltfJson::error_handler_t::replace);
}

void write_text(AtomicFile& file, const GltfJson& document, const GltfBytes& bytes) {
  // A buffer of one member, so that its address can follow behind everything else.
  const std::string text = text_of(document, 1);
  const std::size_t end = text.rfind('}', text.rfind(']'));
  file.write(std::string_view(text).substr(0, end));
  file.write(",\"uri\":\"data:application/octet-stream;base64,");
  Base64Writer out(file);
  bytes([&out](std::span<const std::byte> piece) { out.add(piece); });
  out.finish();
  file.write("\"");
  file.write(std::string_view(text).substr(end));
  file.write("\n");
}

void write_numbers(AtomicFile& file, std::span<const std::uint32_t> numbers) { file.write(std::as_bytes(numbers)); }

void write_binary(AtomicFile& file, const GltfJson& document, std::size_t count, const GltfBytes& bytes) {
  std::string text = text_of(document, -1);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t whole = kHeaderBytes + 2 * kChunkHeaderBytes + text.size() + count;
  write_numbers(file, std::array{kMagic, kVersion, static_cast<std::uint32_t>(whole),
                                 static_cast<std::uint32_t>(text.size()), kTextChunk});
  file.write(text);
  write_numbers(file, std::array{static_cast<std::uint32_t>(count), kBytesChunk});
  bytes([&file](std::span<const std::byte> piece) { file.write(piece); });
}

}  // namespace

GltfJson gltf_document(const std::string& name) {
  GltfJson json;
  json["asset"] = {{"version", "2.0"}, {"generator", "gdtslam " GDTSLAM_VERSION}};
  json["extensionsUsed"] = GltfJson::array({"KHR_materials_unlit"});
  json["scene"] = 0;
  json["scenes"].push_back({{"name", name}, {"nodes", GltfJson::array()}});
  return json;
}

std::array<double, 3> linear_light(Colour colour) {
  return {picture::linear_of(colour.red), picture::linear_of(colour.green), picture::linear_of(colour.blue)};
}

GltfJson gltf_unlit_material(const std::string& name, Colour colour) {
  const std::array<double, 3> light = linear_light(colour);
  return {{"name", name},
          {"pbrMetallicRoughness",
           {{"baseColorFactor", {light[0], light[1], light[2], 1.0}}, {"metallicFactor", 0}, {"roughnessFactor", 1}}},
          {"extensions", GltfJson::object({{"KHR_materials_unlit", GltfJson::object()}})}};
}

void write_gltf_file(const std::string& path, GltfJson document, std::size_t count, const GltfBytes& bytes) {
  assert(count % 4 == 0);
  document["buffers"] = GltfJson::array({GltfJson::object({{"byteLength", count}})});
  AtomicFile file(path);
  if (extension_of(path) == ".glb") {
    write_binary(file, document, count, bytes);
  } else {
    write_text(file, document, bytes);
  }
  file.commit();
}

}  // namespace gdtslam
