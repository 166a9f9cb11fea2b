#include "options.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "engine/io/did_you_mean.hpp"
#include "gdtslam/core/error.hpp"
#include "source.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostSide_px = 16384;
constexpr double kLargestEnd = 1e12;  // of a scale: any two and one more than that are told apart, in degrees too

constexpr std::array<std::pair<std::string_view, CloudColour>, 6> kColours{{{"height", CloudColour::kHeight},
                                                                            {"elevation", CloudColour::kElevation},
                                                                            {"time", CloudColour::kTime},
                                                                            {"scan", CloudColour::kScan},
                                                                            {"distance", CloudColour::kDistance},
                                                                            {"plain", CloudColour::kPlain}}};

// One of the names of a table, else a hint.
template <class Table>
auto chosen_of(const std::string& option, const std::string& name, const Table& table) {
  std::vector<std::string> names;
  std::string list;
  for (const auto& [known, value] : table) {
    if (known == name) return value;
    names.emplace_back(known);
    list += (list.empty() ? "" : ", ") + names.back();
  }
  throw UsageError(fmt::format("{}: '{}' is none of {}{}", option, name, list, did_you_mean(name, names)));
}

Unit scale_unit(CloudColour colour) {
  switch (colour) {
    case CloudColour::kHeight:
    case CloudColour::kDistance:
      return Unit::kMetre;
    case CloudColour::kElevation:
      return Unit::kRadian;
    case CloudColour::kTime:
      return Unit::kSecond;
    case CloudColour::kScan:
    case CloudColour::kPlain:
      break;
  }
  return Unit::kNone;
}

double scale_value(const std::string& text, CloudColour colour) {
  const double value = quantity_of("--range", text, scale_unit(colour));
  if (!(std::abs(value) <= kLargestEnd)) throw UsageError("--range: " + text + " is not between -1e12 and 1e12");
  return value;
}

}  // namespace

bool has_truth(const RenderOptions& options) { return !options.relations.empty() || has_true_path(options); }

bool has_true_path(const RenderOptions& options) {
  if (options.reference.empty()) return false;
  const RenderKind kind = kind_of_input(options.reference);
  if (kind != RenderKind::kRun) return kind == RenderKind::kTrajectory;
  // A run is both where it has a cloud: the path for the views of errors, the points for the others.
  return options.view.starts_with("errors-") || options.view == "trajectory" ||
         RunReader(options.reference).summary().cloud_points == 0;
}

PictureSize size_of(const std::string& text) {
  PictureSize size;
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  const bool has_height = width.ec == std::errc{} && width.ptr != end && *width.ptr == 'x';
  const auto height = has_height ? std::from_chars(width.ptr + 1, end, size.height) : width;
  if (!has_height || height.ec != std::errc{} || height.ptr != end) {
    throw UsageError(fmt::format("--size: '{}' is no WIDTHxHEIGHT in pixels, for example 1280x720", text));
  }
  if (size.width < 1 || size.height < 1 || size.width > kMostSide_px || size.height > kMostSide_px) {
    throw UsageError(fmt::format("--size: {}: each side has 1 to {} pixels", text, kMostSide_px));
  }
  return size;
}

CloudColour cloud_colour_of(const std::string& name) { return chosen_of("--colour", name, kColours); }

ScaleRange scale_range_of(const std::string& text, CloudColour colour) {
  if (text.empty()) return {};
  const std::size_t middle = text.find(':');
  if (middle == std::string::npos || colour == CloudColour::kPlain) {
    throw UsageError("--range: '" + text + "' is no MIN:MAX of the colours, for example 0m:2.5m or -10deg:80deg");
  }
  ScaleRange range;
  if (middle > 0) range.least = scale_value(text.substr(0, middle), colour);
  if (middle + 1 < text.size()) range.most = scale_value(text.substr(middle + 1), colour);
  if (range.least && range.most && *range.least >= *range.most) {
    throw UsageError("--range: " + text + ": the first is not below the second");
  }
  return range;
}

Point2 place_of(const std::string& text) {
  const std::size_t middle = text.find(',');
  if (middle == std::string::npos) throw UsageError("--at: '" + text + "' is no X,Y, for example 1.5m,-2m");
  return {quantity_of("--at", text.substr(0, middle), Unit::kMetre),
          quantity_of("--at", text.substr(middle + 1), Unit::kMetre)};
}

double time_of(const std::string& option, const std::string& text) { return quantity_of(option, text, Unit::kSecond); }

std::string colour_map_of(const std::string& name) {
  if (name.empty()) return name;
  std::vector<std::pair<std::string_view, std::string>> names;
  for (const ColourMap& map : colour_maps()) names.emplace_back(map.name(), std::string(map.name()));
  return chosen_of("--colour-map", name, names);
}

std::string colour_map_names() {
  std::string text;
  for (const ColourMap& map : colour_maps()) text += (text.empty() ? "" : ", ") + std::string(map.name());
  return text;
}

CloudLook cloud_look_of(const RenderOptions& options) {
  CloudLook look;
  const bool has_reference = !options.reference.empty() && !has_truth(options);
  look.colour = !options.colour.empty() ? cloud_colour_of(options.colour)
                : has_reference         ? CloudColour::kDistance
                                        : CloudColour::kHeight;
  look.colour_map = colour_map_of(options.colour_map);
  const ScaleRange range = scale_range_of(options.range, options.is_angle ? CloudColour::kElevation : look.colour);
  look.least = range.least;
  look.most = range.most;
  look.point_px = options.point_px;
  look.is_dark = !options.is_light;
  look.is_transparent = options.is_transparent;
  return look;
}

}  // namespace gdtslam
