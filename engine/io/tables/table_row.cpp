#include "table_row.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/io/decimal.hpp"
#include "engine/io/did_you_mean.hpp"
#include "engine/io/message_text.hpp"

namespace gdtslam {
namespace {

constexpr std::array<std::string_view, kTableNumbers> kTableNames{
    "stamp",       "x",         "y",         "theta",           "laser",     "laser_x",          "laser_y",
    "laser_theta", "angle_min", "angle_max", "angle_increment", "range_max", "first_beam_after", "time_increment",
    "elevation",   "ticks"};
constexpr std::array<std::pair<std::string_view, TableNumber>, 4> kOtherNames{{{"timestamp", TableNumber::kStamp},
                                                                               {"time", TableNumber::kStamp},
                                                                               {"yaw", TableNumber::kTheta},
                                                                               {"heading", TableNumber::kTheta}}};
constexpr std::size_t kShortestHinted = 4;  // so that a column vx is not a misspelt x

std::vector<std::string> hinted_names() {
  std::vector<std::string> names(kTableNames.begin(), kTableNames.end());
  for (const std::string_view other : {kRangesColumn, kPointsColumn, kOdomKey, kMountKey}) names.emplace_back(other);
  for (const auto& [other, number] : kOtherNames) {
    if (other.size() > kShortestHinted) names.emplace_back(other);  // so that type is not a misspelt time
  }
  std::erase_if(names, [](const std::string& one) { return one.size() < kShortestHinted; });
  return names;
}

}  // namespace

std::string_view table_name(TableNumber number) { return kTableNames[static_cast<std::size_t>(number)]; }

std::optional<TableNumber> table_number(std::string_view name) {
  const auto* const found = std::find(kTableNames.begin(), kTableNames.end(), name);
  if (found != kTableNames.end()) return static_cast<TableNumber>(found - kTableNames.begin());
  for (const auto& [other, number] : kOtherNames) {
    if (other == name) return number;
  }
  return std::nullopt;
}

std::optional<TableList> table_list(std::string_view name) {
  if (name == kRangesColumn) return TableList::kRanges;
  return name == kPointsColumn ? std::optional(TableList::kPoints) : std::nullopt;
}

std::optional<TableText> table_text(std::string_view name) {
  if (name == kNameColumn) return TableText::kName;
  return name == kValueColumn ? std::optional(TableText::kValue) : std::nullopt;
}

std::string table_hint(std::string_view name) {
  if (name.size() < kShortestHinted) return {};
  static const std::vector<std::string> names = hinted_names();  // a header may have a hundred thousand columns
  return did_you_mean(name, names);
}

double table_value(std::string_view text, std::string_view column) {
  const char* const end = text.data() + text.size();
  double value = 0.0;
  if (text.empty() || parse_double(text.data(), end, value) != end) {
    throw MalformedRow(fmt::format("has {} as its {}, which is not a number", in_quotes(text), column));
  }
  return value;
}

std::int64_t table_whole(std::string_view text, std::string_view column) {
  const char* const end = text.data() + text.size();
  std::int64_t value = 0;
  if (text.empty() || parse_int64(text.data(), end, value) != end) {
    throw MalformedRow(fmt::format("has {} as its {}, which is not a whole number", in_quotes(text), column));
  }
  return value;
}

}  // namespace gdtslam
