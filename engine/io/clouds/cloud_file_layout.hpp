// How the points of a cloud file are laid out, whatever its format says it in. Thread-safe, constant time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/io/cloud_file.hpp"

namespace gdtslam {

enum class Scalar : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat, kDouble };

std::size_t size_of(Scalar type);
/// The value of a scalar that begins at `data`.
double decode(Scalar type, const char* data, bool is_big_endian);

/// What a column means to us.
enum class CloudRole : std::uint8_t { kX, kY, kZ, kElevation, kTime, kScan, kIgnored };
CloudRole role_of(std::string_view column);
/// The column's name; of the ignored ones "".
std::string_view to_string(CloudRole role);

struct CloudColumn {
  Scalar type = Scalar::kFloat;
  CloudRole role = CloudRole::kIgnored;
  std::optional<Scalar> list_count{};  ///< a list of PLY: its length stands before its items
  std::uint64_t repeat = 1;            ///< values of a column of PCD
  bool is_corner_list = false;         ///< the vertices of a face, of PLY
};

/// A kind of thing that a file holds, with its number; of clouds only vertices matter.
struct CloudElement {
  std::uint64_t count = 0;
  bool is_vertex = false;
  bool is_face = false;
  std::vector<CloudColumn> columns;
};

struct CloudFileLayout {
  CloudHeader header;
  bool is_big_endian = false;
  bool is_compressed = false;
  std::vector<CloudElement> before;  ///< elements that lie before the vertices
  CloudElement vertex;
  bool has_more = false;  ///< other elements lie behind them
};

}  // namespace gdtslam
