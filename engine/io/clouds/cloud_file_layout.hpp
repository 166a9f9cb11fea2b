// Layout of the points in a cloud file of any format, and the readers of its headers. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cloud_input.hpp"
#include "gdtslam/io/cloud_file.hpp"

namespace gdtslam {

enum class Scalar : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat, kDouble };

/// The type by its name in PLY ("uchar", "uint8"), or by TYPE and SIZE in PCD ("U1").
std::optional<Scalar> scalar_named(std::string_view name);
std::size_t byte_size(Scalar type);
/// The value of a scalar that begins at `data`.
double decode(Scalar type, const char* data, bool is_big_endian);

/// The meaning of a column for this program.
enum class CloudRole : std::uint8_t { kX, kY, kZ, kElevation, kTime, kScan, kIgnored };
CloudRole column_role(std::string_view column);
/// The column's name; "" for ignored ones.
std::string_view to_string(CloudRole role);

struct CloudColumn {
  Scalar type = Scalar::kFloat;
  CloudRole role = CloudRole::kIgnored;
  std::optional<Scalar> list_count{};  ///< for a list of PLY: the type of its length, which precedes its items
  std::uint64_t repeat = 1;            ///< number of values in a column of PCD
  bool is_corner_list = false;         ///< the vertices of a face, in PLY
};

/// A kind of element in a file, and its number; clouds need only vertices.
struct CloudElement {
  std::uint64_t count = 0;
  bool is_vertex = false;
  bool is_face = false;
  std::vector<CloudColumn> columns;
};

struct CloudFileLayout {
  CloudHeader header;
  bool is_ascii = false;
  bool is_big_endian = false;
  bool is_compressed = false;
  std::vector<CloudElement> before;  ///< elements before the vertices
  CloudElement vertex;
  bool has_more = false;  ///< other elements follow
};

struct PlyHeader {
  bool is_ascii = false;
  bool is_big_endian = false;
  std::vector<CloudElement> elements;  ///< in the order of the file
};

/// Reads the header of a PLY file [Turk1994] after its first line, "ply", up to "end_header". Throws InputError with
/// the line.
PlyHeader read_ply_elements(CloudInput& input);
/// The same as the layout of a cloud; InputError also if there are no vertices.
CloudFileLayout read_ply_header(CloudInput& input);

/// Reads the header of a PCD file, version 0.7 and earlier, up to the line DATA; `first_line` is already read. Throws
/// InputError with the line.
CloudFileLayout read_pcd_header(CloudInput& input, const std::string& first_line);
/// Unpacks PCD's binary_compressed, LibLZF's format. None if the input is damaged or does not give exactly `size`
/// bytes. Allocates `size` bytes at once: at most 88 times the packed ones make sense.
std::optional<std::string> unpack_lzf(std::string_view packed, std::size_t size);

}  // namespace gdtslam
