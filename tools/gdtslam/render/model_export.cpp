#include "model_export.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/core/base64.hpp"
#include "engine/drawing/maps/cell_number.hpp"
#include "engine/io/atomic_file.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;
using Vector3f = std::array<float, 3>;

static_assert(std::endian::native == std::endian::little, "the format wants little-endian numbers");

// Element types and modes of glTF 2.0, section 3.6.2.2 and 3.7.2.1.
constexpr int kUnsignedShort = 5123;
constexpr int kFloat = 5126;
constexpr int kArrayBuffer = 34962;
constexpr int kModePoints = 0;
constexpr int kLineStrip = 3;

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

Json accessor(int view, int component, std::size_t count, const char* type) {
  return {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}};
}

Json position_accessor(int view, std::size_t count, const Box& box) {
  Json json = accessor(view, kFloat, count, "VEC3");
  json["min"] = box.least;
  json["max"] = box.most;
  return json;
}

Json buffer_view(std::size_t offset, std::size_t length) {
  return {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}, {"target", kArrayBuffer}};
}

Json unlit_material(const char* name, const std::array<double, 3>& colour) {
  return {
      {"name", name},
      {"pbrMetallicRoughness",
       {{"baseColorFactor", {colour[0], colour[1], colour[2], 1.0}}, {"metallicFactor", 0}, {"roughnessFactor", 1}}},
      {"extensions", Json::object({{"KHR_materials_unlit", Json::object()}})}};
}

// Of one primitive. One JSON value in braces is a list to GCC and the value itself to clang; Json::array is a list.
Json mesh(const char* name, const Json& primitive) {
  return {{"name", name}, {"primitives", Json::array({primitive})}};
}

// Bytes as base64 into a file, piece by piece.
class Base64Writer {
 public:
  /// `file` must outlive this.
  explicit Base64Writer(AtomicFile& file) : file_(file) {}

  void add(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    if (bytes_.size() >= kPiece) write(bytes_.size() / 3 * 3);
  }
  /// The value's bytes as they lie in memory.
  template <class T>
  void add_value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(std::as_bytes(std::span(&value, 1)));
  }
  /// What is left, padded; the next bytes begin a text of their own.
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

// All but the bytes; the buffer's address is put in by the writer.
Json gltf_of(const ModelInput& model, std::size_t bytes) {
  const std::size_t points = model.cloud.size();
  const std::size_t poses = path_size(model);
  static const auto table = linear_table();
  const auto linear = [](std::uint8_t value) { return static_cast<double>(table[value]) / 65535.0; };
  Json json;
  json["asset"] = {{"version", "2.0"}, {"generator", "gdtslam " GDTSLAM_VERSION}};
  json["extensionsUsed"] = Json::array({"KHR_materials_unlit"});
  json["scene"] = 0;
  json["scenes"].push_back({{"name", model.name}, {"nodes", Json::array({0})}});
  json["nodes"].push_back({{"name", "cloud"}, {"mesh", 0}});
  json["meshes"].push_back(
      mesh("cloud", {{"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}, {"mode", kModePoints}, {"material", 0}}));
  json["materials"].push_back(unlit_material("points", {1.0, 1.0, 1.0}));
  json["accessors"] = {position_accessor(0, points, box_of(model.cloud)), accessor(1, kUnsignedShort, points, "VEC4")};
  json["accessors"][1]["normalized"] = true;
  json["bufferViews"] = {buffer_view(0, kBytesOfPosition * points),
                         buffer_view(kBytesOfPosition * points, kBytesOfColour * points)};
  if (poses > 1) {
    const Colour& c = model.path_colour;
    json["scenes"][0]["nodes"].push_back(1);
    json["nodes"].push_back({{"name", "path"}, {"mesh", 1}});
    json["meshes"].push_back(
        mesh("path", {{"attributes", Json::object({{"POSITION", 2}})}, {"mode", kLineStrip}, {"material", 1}}));
    json["materials"].push_back(unlit_material("path", {linear(c.red), linear(c.green), linear(c.blue)}));
    json["accessors"].push_back(position_accessor(2, poses, box_of(*model.trajectory)));
    json["bufferViews"].push_back(buffer_view((kBytesOfPosition + kBytesOfColour) * points, kBytesOfPosition * poses));
  }
  json["buffers"].push_back({{"byteLength", bytes}});
  return json;
}

void write_gltf_bytes(AtomicFile& file, const ModelInput& model) {
  static const auto table = linear_table();
  Base64Writer out(file);
  for (const CloudPoint& point : model.cloud) out.add_value(y_up(point));
  for (const Colour& colour : model.colours) {
    out.add_value(std::array<std::uint16_t, 4>{table[colour.red], table[colour.green], table[colour.blue],
                                               std::numeric_limits<std::uint16_t>::max()});
  }
  if (path_size(model) > 1) {
    for (const StampedPose& pose : *model.trajectory) out.add_value(y_up(pose));
  }
  out.finish();
}

}  // namespace

void write_gltf(const std::string& path, const ModelInput& model) {
  if (model.cloud.empty()) throw InputError({path, 0}, "is not written: there are no points");
  assert(model.colours.size() == model.cloud.size());
  const std::size_t poses = path_size(model) > 1 ? path_size(model) : 0;
  const std::size_t bytes = (kBytesOfPosition + kBytesOfColour) * model.cloud.size() + kBytesOfPosition * poses;
  // A buffer of one member, so that its address can follow behind everything else.
  std::string text = gltf_of(model, bytes).dump(1, ' ', true, Json::error_handler_t::replace);
  const std::size_t end = text.rfind('}', text.rfind(']'));
  AtomicFile file(path);
  file.write(std::string_view(text).substr(0, end));
  file.write(",\"uri\":\"data:application/octet-stream;base64,");
  write_gltf_bytes(file, model);
  file.write("\"");
  file.write(std::string_view(text).substr(end));
  file.write("\n");
  file.commit();
}

}  // namespace gdtslam
