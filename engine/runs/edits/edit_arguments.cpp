#include "engine/runs/edits/edit_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>
#include <system_error>

#include "engine/io/line_reader.hpp"
#include "engine/io/message_text.hpp"
#include "engine/runs/folder/loop_files.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kMostMap_m = 1.0e6;
constexpr double kMostWorld_m = 1.0e9;
constexpr std::size_t kMostPlaceLine = 4096;
constexpr std::size_t kMostPlaces = 10'000;  // corners of a region, points of a file
constexpr std::string_view kBlanks = " \t";
constexpr const char* kRegionWanted = "three corners or more, as '1,1 4,1 4,3', nor a file with them";

bool are_below(const std::vector<double>& numbers, std::size_t from, std::size_t count, double most) {
  for (std::size_t k = from; k < from + count; ++k) {
    if (std::fabs(numbers[k]) > most) return false;
  }
  return true;
}

[[noreturn]] void refuse_text(const char* option, const std::string& text, const char* wanted) {
  throw UsageError(fmt::format("{}: {} is not {}", option, in_quotes(text), wanted));
}

bool is_a_file(const std::string& text) {
  std::error_code ignored;
  return std::filesystem::exists(text, ignored);
}

// Calls for every line that is not empty after its comment is removed.
void for_each_place(const std::string& file,
                    const std::function<void(std::string_view text, const FilePosition& position)>& take) {
  LineReader lines(open_file_source(file), kMostPlaceLine);
  std::size_t places = 0;
  while (const std::optional<TextLine> line = lines.next()) {
    const FilePosition position{file, line->number};
    if (line->is_too_long) throw InputError(position, "is too long for the numbers of a place");
    const std::string_view text = line->text.substr(0, line->text.find('#'));
    if (text.find_first_not_of(kBlanks) == std::string_view::npos) continue;
    if (++places > kMostPlaces) throw InputError(position, fmt::format("is one more than {} places", kMostPlaces));
    take(text, position);
  }
}

MapRegion region_in_file(const std::string& file) {
  MapRegion region;
  for_each_place(file, [&region](std::string_view text, const FilePosition& position) {
    const auto numbers = numbers_in(text, ",");
    if (!numbers || numbers->size() != 2 || !are_below(*numbers, 0, 2, kMostMap_m)) {
      throw InputError(position, fmt::format("has {} where a corner should be: x,y in metres", in_quotes(text)));
    }
    region.corners_m.emplace_back((*numbers)[0], (*numbers)[1]);
  });
  if (region.corners_m.size() < 3) {
    throw InputError({file, 0}, "has fewer than three corners, a line each: x,y in metres");
  }
  return region;
}

std::optional<PointPair> pair_in(std::string_view text, std::string_view separators) {
  const auto numbers = numbers_in(text, separators);
  if (!numbers || numbers->size() != 4) return std::nullopt;
  if (!are_below(*numbers, 0, 2, kMostMap_m) || !are_below(*numbers, 2, 2, kMostWorld_m)) return std::nullopt;
  return PointPair{{(*numbers)[0], (*numbers)[1]}, {(*numbers)[2], (*numbers)[3]}};
}

}  // namespace

StatedOrigin parse_origin(const std::string& text) {
  const auto numbers = numbers_in(text, ",");
  if (!numbers || numbers->size() < 2 || numbers->size() > 3) {
    refuse_text("--origin", text, "X,Y or X,Y,THETA: metres and degrees, as 1.5,-2,90");
  }
  if (!are_below(*numbers, 0, numbers->size(), kMostMap_m)) {
    throw UsageError(fmt::format("--origin: {} has a number beyond {:g} m or deg", in_quotes(text), kMostMap_m));
  }
  const bool has_angle = numbers->size() == 3;
  return {{(*numbers)[0], (*numbers)[1], has_angle ? wrap_angle(rad_from_deg((*numbers)[2])) : 0.0}, has_angle};
}

RegionBounds parse_rectangle(const std::string& text) {
  const auto numbers = numbers_in(text, ",");
  if (!numbers || numbers->size() != 4 || !are_below(*numbers, 0, 4, kMostMap_m)) {
    refuse_text("--crop", text, "X0,Y0,X1,Y1: two corners in metres, as -5,-5,20,12.5");
  }
  const std::vector<double>& n = *numbers;
  if (n[0] == n[2] || n[1] == n[3]) refuse_text("--crop", text, "two corners of a rectangle: it has no area");
  const Point2 a{n[0], n[1]};
  const Point2 b{n[2], n[3]};
  return {a.cwiseMin(b), a.cwiseMax(b)};
}

MapRegion parse_region(const std::string& text_or_file) {
  if (is_a_file(text_or_file)) return region_in_file(text_or_file);
  MapRegion region;
  std::string_view rest = text_or_file;
  while (true) {
    const std::size_t begin = rest.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) break;
    rest.remove_prefix(begin);
    const std::size_t length = std::min(rest.find_first_of(kBlanks), rest.size());
    const auto numbers = numbers_in(rest.substr(0, length), ",");
    if (!numbers || numbers->size() != 2 || !are_below(*numbers, 0, 2, kMostMap_m)) {
      refuse_text("--erase", text_or_file, kRegionWanted);
    }
    region.corners_m.emplace_back((*numbers)[0], (*numbers)[1]);
    rest.remove_prefix(length);
  }
  if (region.corners_m.size() < 3) {
    refuse_text("--erase", text_or_file, kRegionWanted);
  }
  return region;
}

std::vector<PointPair> parse_point_pairs(const std::string& text_or_file) {
  if (!is_a_file(text_or_file)) {
    const bool is_a_pair = text_or_file.find('=') != std::string::npos;
    const std::optional<PointPair> pair = is_a_pair ? pair_in(text_or_file, ",=") : std::nullopt;
    if (!pair) {
      refuse_text("--georeference", text_or_file,
                  "a point, x,y=EASTING,NORTHING in metres as 3.2,-1=455012.5,5411930, nor a file with such");
    }
    return {*pair};
  }
  std::vector<PointPair> pairs;
  for_each_place(text_or_file, [&pairs](std::string_view text, const FilePosition& position) {
    const std::optional<PointPair> pair = pair_in(text, ",=");
    if (!pair) {
      throw InputError(position,
                       fmt::format("has {} where a point should be: x,y=EASTING,NORTHING in metres", in_quotes(text)));
    }
    pairs.push_back(*pair);
  });
  return pairs;
}

}  // namespace gdtslam
