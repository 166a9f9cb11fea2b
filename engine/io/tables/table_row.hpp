// The values that one row of a CSV file or one JSON line states, before their meaning is known. The names are those of
// docs/formats.md; metres, radians, seconds. Thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

/// A row that breaks its format; what() states the fault with the name of the column.
class MalformedRow : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class TableNumber : std::uint8_t {
  kStamp,
  kX,
  kY,
  kTheta,
  kLaser,
  kLaserX,
  kLaserY,
  kLaserTheta,
  kAngleMin,
  kAngleMax,
  kAngleIncrement,
  kRangeMax,
  kFirstBeamAfter,
  kTimeIncrement,
  kElevation,
  kTicks,  // last, because it alone is a whole number
};
inline constexpr std::size_t kTableNumbers = static_cast<std::size_t>(TableNumber::kTicks) + 1;

/// Names of columns without a number: lists, name and value of a parameter, and poses, which only JSON has.
inline constexpr std::string_view kRangesColumn = "ranges";
inline constexpr std::string_view kPointsColumn = "points";
inline constexpr std::string_view kNameColumn = "name";
inline constexpr std::string_view kValueColumn = "value";
inline constexpr std::string_view kOdomKey = "odom";
inline constexpr std::string_view kMountKey = "mount";

/// Other kinds of columns.
enum class TableList : std::uint8_t { kRanges, kPoints };
enum class TableText : std::uint8_t { kName, kValue };

struct TableRow {
  std::array<std::optional<double>, kTableNumbers> numbers{};  ///< all but the ticks
  std::optional<std::int64_t> ticks{};
  bool has_ranges = false;
  bool has_points = false;
  std::vector<double> ranges_m{};
  std::vector<double> points_m{};  ///< x and y in turn, in the laser's frame
  std::optional<std::string> name{};
  std::string value{};

  std::optional<double>& operator[](TableNumber number) { return numbers[static_cast<std::size_t>(number)]; }
  const std::optional<double>& operator[](TableNumber number) const {
    return numbers[static_cast<std::size_t>(number)];
  }
};

/// The name of the column, for messages.
std::string_view table_name(TableNumber number);

/// By its name or one of its other names (timestamp, time, yaw, heading), in small letters.
std::optional<TableNumber> table_number(std::string_view name);
std::optional<TableList> table_list(std::string_view name);
std::optional<TableText> table_text(std::string_view name);

/// "; did you mean 'angle_min'?" for a name of four letters or more that is no column but resembles one; else empty.
std::string table_hint(std::string_view name);

/// The whole text as a number. Throws MalformedRow with the column.
double table_value(std::string_view text, std::string_view column);
std::int64_t table_whole(std::string_view text, std::string_view column);

}  // namespace gdtslam
