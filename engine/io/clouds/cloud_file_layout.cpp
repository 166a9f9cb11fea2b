#include "cloud_file_layout.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>

namespace gdtslam {
namespace {

constexpr std::array<std::pair<std::string_view, CloudRole>, 6> kNames{{{"x", CloudRole::kX},
                                                                        {"y", CloudRole::kY},
                                                                        {"z", CloudRole::kZ},
                                                                        {"elevation", CloudRole::kElevation},
                                                                        {"time", CloudRole::kTime},
                                                                        {"scan", CloudRole::kScan}}};

template <class T>
double decoded(const char* data, bool is_big_endian) {
  std::array<char, sizeof(T)> bytes{};
  std::copy_n(data, sizeof(T), bytes.begin());
  if (is_big_endian != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.end());
  return static_cast<double>(std::bit_cast<T>(bytes));
}

}  // namespace

std::size_t size_of(Scalar type) {
  switch (type) {
    case Scalar::kInt8:
    case Scalar::kUint8:
      return 1;
    case Scalar::kInt16:
    case Scalar::kUint16:
      return 2;
    case Scalar::kInt32:
    case Scalar::kUint32:
    case Scalar::kFloat:
      return 4;
    case Scalar::kInt64:
    case Scalar::kUint64:
    case Scalar::kDouble:
      break;
  }
  return 8;
}

double decode(Scalar type, const char* data, bool is_big_endian) {
  switch (type) {
    case Scalar::kInt8:
      return decoded<std::int8_t>(data, is_big_endian);
    case Scalar::kUint8:
      return decoded<std::uint8_t>(data, is_big_endian);
    case Scalar::kInt16:
      return decoded<std::int16_t>(data, is_big_endian);
    case Scalar::kUint16:
      return decoded<std::uint16_t>(data, is_big_endian);
    case Scalar::kInt32:
      return decoded<std::int32_t>(data, is_big_endian);
    case Scalar::kUint32:
      return decoded<std::uint32_t>(data, is_big_endian);
    case Scalar::kInt64:
      return decoded<std::int64_t>(data, is_big_endian);
    case Scalar::kUint64:
      return decoded<std::uint64_t>(data, is_big_endian);
    case Scalar::kFloat:
      return decoded<float>(data, is_big_endian);
    case Scalar::kDouble:
      break;
  }
  return decoded<double>(data, is_big_endian);
}

CloudRole role_of(std::string_view column) {
  for (const auto& [name, role] : kNames) {
    if (column == name) return role;
  }
  return CloudRole::kIgnored;
}

std::string_view to_string(CloudRole wanted) {
  for (const auto& [name, role] : kNames) {
    if (role == wanted) return name;
  }
  return {};
}

}  // namespace gdtslam
