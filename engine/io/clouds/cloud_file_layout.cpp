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

/// In the order of Scalar.
struct ScalarKind {
  std::size_t size;
  double (*decode)(const char* data, bool is_big_endian);
  std::array<std::string_view, 3> names;  ///< two names in PLY and one in PCD
};
constexpr std::array<ScalarKind, 10> kScalars{{{1, decoded<std::int8_t>, {"char", "int8", "I1"}},
                                               {1, decoded<std::uint8_t>, {"uchar", "uint8", "U1"}},
                                               {2, decoded<std::int16_t>, {"short", "int16", "I2"}},
                                               {2, decoded<std::uint16_t>, {"ushort", "uint16", "U2"}},
                                               {4, decoded<std::int32_t>, {"int", "int32", "I4"}},
                                               {4, decoded<std::uint32_t>, {"uint", "uint32", "U4"}},
                                               {8, decoded<std::int64_t>, {"int64", "int64", "I8"}},
                                               {8, decoded<std::uint64_t>, {"uint64", "uint64", "U8"}},
                                               {4, decoded<float>, {"float", "float32", "F4"}},
                                               {8, decoded<double>, {"double", "float64", "F8"}}}};
static_assert(kScalars.size() == static_cast<std::size_t>(Scalar::kDouble) + 1);

const ScalarKind& scalar_kind(Scalar type) { return kScalars[static_cast<std::size_t>(type)]; }

}  // namespace

std::optional<Scalar> scalar_named(std::string_view name) {
  for (std::size_t k = 0; k < kScalars.size(); ++k) {
    const auto& names = kScalars[k].names;
    if (std::find(names.begin(), names.end(), name) != names.end()) return static_cast<Scalar>(k);
  }
  return std::nullopt;
}

std::size_t byte_size(Scalar type) { return scalar_kind(type).size; }

double decode(Scalar type, const char* data, bool is_big_endian) {
  return scalar_kind(type).decode(data, is_big_endian);
}

CloudRole column_role(std::string_view column) {
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
