#include "options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "engine/io/did_you_mean.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "source.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostSide_px = 16384;
constexpr double kLargestEnd = 1e12;  // farthest end of a scale: beyond it both ends could be one number in degrees

constexpr std::array<std::pair<std::string_view, CloudColour>, 6> kColours{{{"height", CloudColour::kHeight},
                                                                            {"elevation", CloudColour::kElevation},
                                                                            {"time", CloudColour::kTime},
                                                                            {"scan", CloudColour::kScan},
                                                                            {"distance", CloudColour::kDistance},
                                                                            {"plain", CloudColour::kPlain}}};
constexpr std::array<std::pair<std::string_view, CameraPreset>, 5> kViewpoints{{{"iso", CameraPreset::kIso},
                                                                                {"top", CameraPreset::kTop},
                                                                                {"front", CameraPreset::kFront},
                                                                                {"side", CameraPreset::kSide},
                                                                                {"robot", CameraPreset::kFollow}}};
constexpr std::array<std::pair<std::string_view, Background>, 3> kBackgrounds{
    {{"dark", Background::kDark}, {"light", Background::kLight}, {"none", Background::kNone}}};
constexpr std::array<std::pair<std::string_view, bool Hidden::*>, 5> kHidden{{{"floor", &Hidden::floor},
                                                                              {"ceiling", &Hidden::ceiling},
                                                                              {"path", &Hidden::path},
                                                                              {"caption", &Hidden::caption},
                                                                              {"none", &Hidden::nothing}}};

template <class Table>
std::vector<std::string> names_in(const Table& table) {
  std::vector<std::string> names;
  names.reserve(table.size());
  for (const auto& [name, value] : table) names.emplace_back(name);
  return names;
}

[[noreturn]] void fail_word(std::string_view option, const std::string& word, const std::vector<std::string>& names) {
  throw UsageError(fmt::format("{}: '{}' is none of {}{}", option, word, listed(names), did_you_mean(word, names)));
}

template <class Table>
auto read_word(std::string_view option, std::string_view word, const Table& table) {
  for (const auto& [name, value] : table) {
    if (name == word) return value;
  }
  fail_word(option, std::string(word), names_in(table));
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

/// The two sides of "MIN:MAX"; an empty side is open.
OpenRange read_ends(const std::string& option, const std::string& text, Unit unit, std::string_view example) {
  const std::size_t middle = text.find(':');
  if (middle == std::string::npos) {
    throw UsageError(fmt::format("{}: '{}' is not MIN:MAX, for example {}", option, text, example));
  }
  const auto end = [&](const std::string& part) -> std::optional<double> {
    if (part.empty()) return std::nullopt;
    const double value = quantity_of(option, part, unit);
    if (std::abs(value) <= kLargestEnd) return value;
    throw UsageError(fmt::format("{}: {} is not between -1e12 and 1e12", option, part));
  };
  const auto least = end(text.substr(0, middle));
  const auto most = end(text.substr(middle + 1));
  if (least && most && *least >= *most) {
    throw UsageError(fmt::format("{}: {}: the first is not below the second", option, text));
  }
  return {least, most};
}

}  // namespace

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::vector<std::string> option_words(std::string_view option) {
  if (option == "--from") return names_in(kViewpoints);
  if (option == "--background") return names_in(kBackgrounds);
  return option == "--hide" ? names_in(kHidden) : names_in(kColours);
}
std::vector<std::string> colour_map_names() {
  std::vector<std::string> names;
  for (const ColourMap& map : colour_maps()) names.emplace_back(map.name());
  return names;
}

bool has_truth(const RenderOptions& options) { return !options.relations.empty() || has_true_path(options); }

bool has_true_path(const RenderOptions& options) {
  if (options.reference.empty()) return false;
  const RenderKind kind = kind_of_input(options.reference);
  if (kind != RenderKind::kRun) return kind == RenderKind::kTrajectory;
  // A run with a cloud fits both: its path for the views of errors, its points for the others.
  return options.view == "errors" || options.view == "trajectory" ||
         RunReader(options.reference).summary().cloud_points == 0;
}

PictureSize read_size(const std::string& text) {
  PictureSize size;
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  const bool has_height = width.ec == std::errc{} && width.ptr != end && *width.ptr == 'x';
  const auto height = has_height ? std::from_chars(width.ptr + 1, end, size.height) : width;
  if (!has_height || height.ec != std::errc{} || height.ptr != end) {
    throw UsageError(fmt::format("--size: '{}' is not WIDTHxHEIGHT in pixels, for example 1280x720", text));
  }
  if (size.width < 1 || size.height < 1 || size.width > kMostSide_px || size.height > kMostSide_px) {
    throw UsageError(fmt::format("--size: {}: each side has 1 to {} pixels", text, kMostSide_px));
  }
  return size;
}

Viewpoint read_viewpoint(const std::string& text) {
  Viewpoint viewpoint;
  if (text.find(',') != std::string::npos) {
    viewpoint.camera = parse_camera(text);
  } else if (!text.empty()) {
    viewpoint.preset = read_word("--from", text, kViewpoints);
  }
  return viewpoint;
}

Background read_background(const std::string& text) {
  return text.empty() ? Background::kDefault : read_word("--background", text, kBackgrounds);
}

Hidden read_hidden(const std::string& text) {
  Hidden hidden;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    hidden.*read_word("--hide", std::string_view(text).substr(begin, end - begin), kHidden) = true;
    begin = end + 1;
  }
  if (hidden.nothing && text != "none") throw UsageError("--hide: none stands alone");
  return hidden;
}

OpenRange read_scale_range(const std::string& text, CloudColour colour) {
  if (text.empty()) return {};
  if (colour == CloudColour::kPlain) throw UsageError("--range: points of one colour have no scale");
  return read_ends("--range", text, scale_unit(colour), "0m:2.5m or -10deg:80deg");
}

OpenRange read_time_range(const std::string& text) {
  if (text.empty()) return {};
  return read_ends("--time", text, Unit::kSecond, "20s:60s");
}

CloudLook read_cloud_look(const RenderOptions& options) {
  CloudLook look;
  const bool has_reference = !options.reference.empty() && !has_truth(options);
  look.colour = !options.colour.empty() ? read_word("--colour", options.colour, kColours)
                : has_reference         ? CloudColour::kDistance
                                        : CloudColour::kHeight;
  const std::vector<std::string> maps = colour_map_names();
  look.colour_map = options.colour_map;
  if (!look.colour_map.empty() && std::find(maps.begin(), maps.end(), look.colour_map) == maps.end()) {
    fail_word("--colour-map", look.colour_map, maps);
  }
  const OpenRange range = read_scale_range(options.range, look.colour);
  look.least = range.least;
  look.most = range.most;
  const Background background = read_background(options.background);
  look.is_dark = background != Background::kLight;
  look.is_transparent = background == Background::kNone;
  return look;
}

}  // namespace gdtslam
