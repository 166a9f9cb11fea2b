#include "model_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "base64_writer.hpp"
#include "gdtslam/core/elementary.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/atomic_file.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;
using Vector3f = std::array<float, 3>;

static_assert(std::endian::native == std::endian::little, "both formats want little-endian numbers");

// Element types and modes of glTF 2.0, section 3.6.2.2 and 3.7.2.1.
constexpr int kUnsignedShort = 5123;
constexpr int kFloat = 5126;
constexpr int kArrayBuffer = 34962;
constexpr int kPoints = 0;
constexpr int kLineStrip = 3;

constexpr std::size_t kBytesOfPosition = 12;
constexpr std::size_t kBytesOfColour = 8;

void require_points(const std::string& path, const ModelInput& model) {
  if (model.cloud.empty()) throw InputError({path, 0}, "is not written: there are no points");
  assert(model.colours.size() == model.cloud.size());
}

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

// The linear share of an sRGB value as 16 bits, IEC 61966-2-1.
std::array<std::uint16_t, 256> linear_table() {
  std::array<std::uint16_t, 256> table{};
  for (std::size_t k = 0; k < table.size(); ++k) {
    const double share = static_cast<double>(k) / 255.0;
    const double linear = share <= 0.04045 ? share / 12.92 : exp(2.4 * log((share + 0.055) / 1.055));
    table[k] = static_cast<std::uint16_t>(linear * 65535.0 + 0.5);
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
      {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
}

// All but the bytes; the buffer's address is put in by the writer.
Json gltf_of(const ModelInput& model, std::size_t bytes) {
  const std::size_t points = model.cloud.size();
  const std::size_t poses = path_size(model);
  static const auto table = linear_table();
  const auto linear = [](std::uint8_t value) { return static_cast<double>(table[value]) / 65535.0; };
  Json json;
  json["asset"] = {{"version", "2.0"}, {"generator", "gdtslam " GDTSLAM_VERSION}};
  json["extensionsUsed"] = {"KHR_materials_unlit"};
  json["scene"] = 0;
  json["scenes"] = {{{"name", model.name}, {"nodes", {0}}}};
  json["nodes"] = {{{"name", "cloud"}, {"mesh", 0}}};
  json["meshes"] = {
      {{"name", "cloud"},
       {"primitives", {{{"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}, {"mode", kPoints}, {"material", 0}}}}}};
  json["materials"] = {unlit_material("points", {1.0, 1.0, 1.0})};
  json["accessors"] = {position_accessor(0, points, box_of(model.cloud)), accessor(1, kUnsignedShort, points, "VEC4")};
  json["accessors"][1]["normalized"] = true;
  json["bufferViews"] = {buffer_view(0, kBytesOfPosition * points),
                         buffer_view(kBytesOfPosition * points, kBytesOfColour * points)};
  if (poses > 1) {
    const Colour& c = model.path_colour;
    json["scenes"][0]["nodes"].push_back(1);
    json["nodes"].push_back({{"name", "path"}, {"mesh", 1}});
    json["meshes"].push_back(
        {{"name", "path"},
         {"primitives", {{{"attributes", {{"POSITION", 2}}}, {"mode", kLineStrip}, {"material", 1}}}}});
    json["materials"].push_back(unlit_material("path", {linear(c.red), linear(c.green), linear(c.blue)}));
    json["accessors"].push_back(position_accessor(2, poses, box_of(*model.trajectory)));
    json["bufferViews"].push_back(buffer_view((kBytesOfPosition + kBytesOfColour) * points, kBytesOfPosition * poses));
  }
  json["buffers"] = {{{"byteLength", bytes}}};
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

// One piece of a .vtp: its points are one cell, a bunch of vertices or a line.
class PieceWriter {
 public:
  PieceWriter(AtomicFile& file, std::size_t points, bool is_line) : file_(file), points_(points), is_line_(is_line) {
    file_.write(
        fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" "
                    "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
                    points, is_line ? 0 : 1, is_line ? 1 : 0));
  }
  // `value(k)` gives the k-th entry as it lies in memory.
  template <class Value>
  void array(const char* type, const char* name, int components, std::size_t count, const Value& value) {
    file_.write(fmt::format("        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">",
                            type, name, components));
    Base64Writer out(file_);
    out.add_value(static_cast<std::uint64_t>(count * (count > 0 ? sizeof(value(0)) : 0)));
    for (std::size_t k = 0; k < count; ++k) out.add_value(value(k));
    out.finish();
    file_.write("</DataArray>\n");
  }
  void finish() {
    cells("Verts", is_line_ ? 0 : points_);
    cells("Lines", is_line_ ? points_ : 0);
    file_.write("    </Piece>\n");
  }

 private:
  void cells(const char* name, std::size_t count) {
    file_.write(fmt::format("      <{}>\n", name));
    array("Int64", "connectivity", 1, count, [](std::size_t k) { return static_cast<std::int64_t>(k); });
    array("Int64", "offsets", 1, count > 0 ? 1 : 0, [count](std::size_t) { return static_cast<std::int64_t>(count); });
    file_.write(fmt::format("      </{}>\n", name));
  }

  AtomicFile& file_;
  std::size_t points_;
  bool is_line_;
};

template <class Attributes>
void write_attributes(AtomicFile& file, PieceWriter& piece, std::size_t count, const Attributes& at) {
  file.write("      <PointData Scalars=\"colour\">\n");
  piece.array("Float32", "elevation", 1, count, [&at](std::size_t k) { return at(k).elevation_rad; });
  piece.array("Float64", "time", 1, count, [&at](std::size_t k) { return at(k).stamp_s; });
  piece.array("UInt32", "scan", 1, count, [&at](std::size_t k) { return at(k).scan; });
}

void write_points(AtomicFile& file, PieceWriter& piece, std::size_t count,
                  const std::function<Vector3f(std::size_t)>& place, const std::function<Colour(std::size_t)>& colour) {
  piece.array("UInt8", "colour", 3, count, [&colour](std::size_t k) {
    const Colour c = colour(k);
    return std::array<std::uint8_t, 3>{c.red, c.green, c.blue};
  });
  file.write("      </PointData>\n      <Points>\n");
  piece.array("Float32", "Points", 3, count, place);
  file.write("      </Points>\n");
  piece.finish();
}

void write_cloud_piece(AtomicFile& file, const ModelInput& model) {
  const std::span<const CloudPoint> cloud = model.cloud;
  PieceWriter piece(file, cloud.size(), false);
  write_attributes(file, piece, cloud.size(), [cloud](std::size_t k) { return cloud[k]; });
  write_points(
      file, piece, cloud.size(),
      [cloud](std::size_t k) {
        return Vector3f{cloud[k].x_m, cloud[k].y_m, cloud[k].z_m};
      },
      [&model](std::size_t k) { return model.colours[k]; });
}

void write_path_piece(AtomicFile& file, const ModelInput& model) {
  const Trajectory& path = *model.trajectory;
  PieceWriter piece(file, path.size(), true);
  write_attributes(file, piece, path.size(), [&path](std::size_t k) {
    return CloudPoint{.stamp_s = path[k].stamp_s, .scan = static_cast<std::uint32_t>(k)};
  });
  write_points(
      file, piece, path.size(),
      [&path](std::size_t k) {
        return Vector3f{static_cast<float>(path[k].T_map_base.x_m), static_cast<float>(path[k].T_map_base.y_m), 0.0F};
      },
      [&model](std::size_t) { return model.path_colour; });
}

}  // namespace

void write_gltf(const std::string& path, const ModelInput& model) {
  require_points(path, model);
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

void write_vtp(const std::string& path, const ModelInput& model) {
  require_points(path, model);
  AtomicFile file(path);
  file.write(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n  <PolyData>\n");
  write_cloud_piece(file, model);
  if (path_size(model) > 1) write_path_piece(file, model);
  file.write("  </PolyData>\n</VTKFile>\n");
  file.commit();
}

}  // namespace gdtslam
