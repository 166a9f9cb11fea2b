#include "page_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "engine/drawing/markup.hpp"
#include "engine/io/maps/png.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam::live_page {
std::string_view skeleton();
std::string_view style();
std::string_view style_hash();
std::string_view program();
std::string_view program_hash();
}  // namespace gdtslam::live_page

namespace gdtslam {
namespace {

constexpr std::int32_t kMostPixels = 2048;  // a side
constexpr std::size_t kMostPlaces = 4000;   // of the path
constexpr std::uint8_t kOccupied = 0;
constexpr std::uint8_t kUnknown = 128;
constexpr std::uint8_t kFree = 255;

long long centimetres(double value_m) { return std::llround(100.0 * value_m); }

// Walls stay whole however small the map is drawn.
void darken(std::uint8_t& pixel, CellState state) {
  if (state == CellState::kOccupied) pixel = kOccupied;
  if (state == CellState::kFree && pixel == kUnknown) pixel = kFree;
}

struct Picture {
  std::int32_t cells = 1;  // that a pixel has a side
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::string png;
};

Picture picture_of(const OccupancyMap& map) {
  const GridGeometry& grid = map.geometry;
  Picture picture;
  picture.cells = std::max(1, (std::max(grid.width, grid.height) + kMostPixels - 1) / kMostPixels);
  picture.width = (grid.width + picture.cells - 1) / picture.cells;
  picture.height = (grid.height + picture.cells - 1) / picture.cells;
  PngWriter writer(static_cast<std::uint32_t>(picture.width), static_cast<std::uint32_t>(picture.height),
                   PngWriter::Pixels::kGrey8, [&picture](std::span<const std::byte> bytes) {
                     picture.png.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
                   });
  std::vector<CellState> states(static_cast<std::size_t>(grid.width));
  std::vector<std::uint8_t> row(static_cast<std::size_t>(picture.width));
  for (std::int32_t v = picture.height - 1; v >= 0; --v) {
    std::fill(row.begin(), row.end(), kUnknown);
    for (std::int32_t y = v * picture.cells; y < std::min((v + 1) * picture.cells, grid.height); ++y) {
      map.read_row(y, states);
      for (std::size_t x = 0; x < states.size(); ++x) {
        darken(row[x / static_cast<std::size_t>(picture.cells)], states[x]);
      }
    }
    writer.add_row(std::as_bytes(std::span(row)));
  }
  writer.finish();
  return picture;
}

std::string path_text(const Trajectory& path) {
  const std::size_t step = std::max<std::size_t>(1, path.size() / kMostPlaces);
  std::string text;
  const auto add = [&text](const Pose2& pose) {
    text += fmt::format("{}{},{}", text.empty() ? "" : ",", centimetres(pose.x_m), centimetres(pose.y_m));
  };
  for (std::size_t i = 0; i + 1 < path.size(); i += step) add(path[i].T_map_base);
  if (!path.empty()) add(path.back().T_map_base);
  return text;
}

// As they were matched: those that count, each from where the robot was when it was measured.
std::string points_text(const ShownScan& shown, const Pose2& T_map_base) {
  std::string text;
  for (const Point2& point_base_m : points_of(shown.laser, shown.valid)) {
    const Point2 point_m = T_map_base * point_base_m;
    text += fmt::format("{}{},{}", text.empty() ? "" : ",", centimetres(point_m.x()), centimetres(point_m.y()));
  }
  return text;
}

}  // namespace

std::string scan_message(const ShownScan& shown, std::string_view drive) {
  nlohmann::ordered_json figures = nlohmann::ordered_json::object();
  for (const auto& [name, value] : shown.figures()) figures[name] = value;
  std::string pose = "null";
  std::string points;
  if (shown.T_map_base) {
    const Pose2& T = *shown.T_map_base;
    pose = fmt::format("[{:.4f},{:.4f},{:.5f}]", T.x_m, T.y_m, T.theta_rad);
    points = points_text(shown, T);
  }
  return fmt::format("{{\"drive\":\"{}\",\"scan\":{},\"pose\":{},\"inDoubt\":{},\"figures\":{},\"points\":[{}]}}",
                     drive, shown.scan, pose, shown.is_in_doubt, figures.dump(), points);
}

std::string sign_of_life_message(std::string_view drive, std::string_view title) {
  const nlohmann::ordered_json message{{"drive", drive}, {"title", title}};
  return message.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string map_message(const OccupancyMap& map, const Trajectory& path, std::string_view drive) {
  const Picture picture = picture_of(map);
  const double pixel_m = map.geometry.resolution_m * picture.cells;
  const Point2 corner_m = map.geometry.centre_of({0, 0}) - 0.5 * map.geometry.resolution_m * Point2(1.0, 1.0);
  const std::string header = fmt::format(
      "{{\"drive\":\"{}\",\"width\":{},\"height\":{},\"pixel_m\":{},\"corner_m\":[{},{}],\"scans\":{},\"path\":[{}]}}",
      drive, picture.width, picture.height, pixel_m, corner_m.x(), corner_m.y(), path.size(), path_text(path));
  std::string message;
  for (std::size_t byte = 0; byte < 4; ++byte) message += static_cast<char>(header.size() >> (8 * byte) & 0xffU);
  return message + header + picture.png;
}

std::string live_page_text(const std::string& title) {
  std::string_view skeleton = live_page::skeleton();
  std::string page;
  for (std::size_t begin = 0; (begin = skeleton.find("{{")) != std::string_view::npos;) {
    const std::size_t end = skeleton.find("}}", begin);
    const std::string_view name = skeleton.substr(begin + 2, end - begin - 2);
    page += skeleton.substr(0, begin);
    if (name == "title") page += markup_text(title);
    if (name == "style") page += live_page::style();
    if (name == "script") page += live_page::program();
    skeleton.remove_prefix(end + 2);
  }
  return page += skeleton;
}

std::string live_page_policy() {
  return fmt::format(
      "default-src 'none'; style-src {}; script-src {}; connect-src 'self'; frame-ancestors 'none'; "
      "base-uri 'none'; form-action 'none'",
      live_page::style_hash(), live_page::program_hash());
}

}  // namespace gdtslam
