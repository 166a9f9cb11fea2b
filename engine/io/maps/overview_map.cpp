#include "overview_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace gdtslam {
namespace {

constexpr PixelColour kFree{255, 255, 255};
constexpr PixelColour kUnknown{214, 220, 227};
constexpr PixelColour kOccupied{23, 32, 42};
constexpr double kMarginShare = 0.02;
constexpr double kStrayShare = 0.004;

void include(MapArea& area, bool& is_empty, const MapArea& other) {
  if (is_empty) {
    area = other;
    is_empty = false;
    return;
  }
  area.min_x_m = std::min(area.min_x_m, other.min_x_m);
  area.min_y_m = std::min(area.min_y_m, other.min_y_m);
  area.max_x_m = std::max(area.max_x_m, other.max_x_m);
  area.max_y_m = std::max(area.max_y_m, other.max_y_m);
}

/// Number of occupied cells in every column and row.
struct OccupiedProfile {
  std::vector<std::uint64_t> columns;
  std::vector<std::uint64_t> rows;
  std::uint64_t total = 0;
};
OccupiedProfile occupied_profile(const OccupancyMap& map) {
  const GridGeometry& geometry = map.geometry;
  OccupiedProfile profile;
  profile.columns.resize(static_cast<std::size_t>(geometry.width));
  profile.rows.resize(static_cast<std::size_t>(geometry.height));
  for (std::int32_t y = 0; y < geometry.height; ++y) {
    for (std::int32_t x = 0; x < geometry.width; ++x) {
      const std::uint64_t is_occupied = map.at({x, y}) == CellState::kOccupied ? 1 : 0;
      profile.columns[static_cast<std::size_t>(x)] += is_occupied;
      profile.rows[static_cast<std::size_t>(y)] += is_occupied;
      profile.total += is_occupied;
    }
  }
  return profile;
}

/// First and past-the-last index when at most `spare` counts may be cut off at either end.
std::pair<std::int32_t, std::int32_t> trimmed(const std::vector<std::uint64_t>& counts, std::uint64_t spare) {
  std::size_t begin = 0;
  std::size_t end = counts.size();
  for (std::uint64_t cut = 0; begin < end && cut + counts[begin] <= spare; ++begin) {
    cut += counts[begin];
  }
  for (std::uint64_t cut = 0; end > begin && cut + counts[end - 1] <= spare; --end) {
    cut += counts[end - 1];
  }
  return {static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end)};
}

/// The cells that are occupied, as a box; empty when none is. Free cells do not count: beams through windows reach far
/// and would shrink the building. Nor do the few occupied ones (kStrayShare of all at each side) in which such beams
/// end.
CellBox occupied_box(const OccupancyMap& map) {
  const OccupiedProfile profile = occupied_profile(map);
  const auto spare = static_cast<std::uint64_t>(std::ceil(kStrayShare * static_cast<double>(profile.total)));
  const auto [left, right] = trimmed(profile.columns, spare);
  const auto [bottom, top] = trimmed(profile.rows, spare);
  return {{left, bottom}, {right, top}};
}

/// The known cells, for a map in which nothing is occupied.
CellBox known_box(const OccupancyMap& map) {
  CellBox box{{map.geometry.width, map.geometry.height}, {0, 0}};
  for (std::int32_t y = 0; y < map.geometry.height; ++y) {
    for (std::int32_t x = 0; x < map.geometry.width; ++x) {
      if (map.at({x, y}) != CellState::kUnknown) {
        box.min = {std::min(box.min.x, x), std::min(box.min.y, y)};
        box.end = {std::max(box.end.x, x + 1), std::max(box.end.y, y + 1)};
      }
    }
  }
  return box;
}

MapArea area_of(const GridGeometry& geometry, const CellBox& box) {
  const double cell_m = geometry.resolution_m;
  return {geometry.origin_x_m + cell_m * box.min.x, geometry.origin_y_m + cell_m * box.min.y,
          geometry.origin_x_m + cell_m * box.end.x, geometry.origin_y_m + cell_m * box.end.y};
}

/// How much of each kind lies under a pixel, shares of its area.
struct Content {
  double free = 0.0;
  double occupied = 0.0;
};

/// A pixel's extent in cells.
struct CellSpan {
  double begin;
  double end;
  [[nodiscard]] std::int32_t first(std::int32_t size) const { return clamped(std::floor(begin), size); }
  [[nodiscard]] std::int32_t last(std::int32_t size) const { return clamped(std::ceil(end), size); }
  [[nodiscard]] double share_of(std::int32_t cell) const {
    const double low = static_cast<double>(cell);
    return std::max(0.0, std::min(low + 1.0, end) - std::max(low, begin)) / (end - begin);
  }
  static std::int32_t clamped(double value, std::int32_t size) {
    return static_cast<std::int32_t>(std::clamp(value, 0.0, static_cast<double>(size)));
  }
};

Content content_of(const OccupancyMap& map, const CellSpan& columns, const CellSpan& rows) {
  const GridGeometry& geometry = map.geometry;
  Content content;
  for (std::int32_t y = rows.first(geometry.height); y < rows.last(geometry.height); ++y) {
    for (std::int32_t x = columns.first(geometry.width); x < columns.last(geometry.width); ++x) {
      const double share = columns.share_of(x) * rows.share_of(y);
      const CellState state = map.at({x, y});
      content.free += state == CellState::kFree ? share : 0.0;
      content.occupied += state == CellState::kOccupied ? share : 0.0;
    }
  }
  return content;
}

PixelColour colour_for(const Content& content, double cells_per_pixel) {
  const double rest = std::max(0.0, 1.0 - content.occupied);
  const double known = rest > 0.0 ? std::min(1.0, content.free / rest) : 0.0;
  const double weight = std::max(1.0, cells_per_pixel);
  return mix(mix(kUnknown, kFree, known), kOccupied, std::min(1.0, weight * content.occupied));
}

}  // namespace

MapArea shown_area(const OverviewInput& input) {
  const GridGeometry& geometry = input.map.geometry;
  MapArea area;
  bool is_empty = true;
  const CellBox occupied = occupied_box(input.map);
  const CellBox box = occupied.empty() ? known_box(input.map) : occupied;
  if (!box.empty()) {
    include(area, is_empty, area_of(geometry, box));
  }
  // A pose that lies farther out than the map is long would leave nothing to see of the map; it is clipped.
  const double reach_m = geometry.resolution_m * std::max(geometry.width, geometry.height);
  const MapArea grid = area_of(geometry, {{0, 0}, {geometry.width, geometry.height}});
  for (const StampedPose& pose : input.trajectory) {
    const Pose2& T = pose.T_map_base;
    const bool is_near = T.x_m >= grid.min_x_m - reach_m && T.x_m <= grid.max_x_m + reach_m &&
                         T.y_m >= grid.min_y_m - reach_m && T.y_m <= grid.max_y_m + reach_m;
    if (is_near) {
      include(area, is_empty, {T.x_m, T.y_m, T.x_m, T.y_m});
    }
  }
  const double margin_m =
      std::max(0.5, kMarginShare * std::max(area.max_x_m - area.min_x_m, area.max_y_m - area.min_y_m));
  return {area.min_x_m - margin_m, area.min_y_m - margin_m, area.max_x_m + margin_m, area.max_y_m + margin_m};
}

void draw_map(RgbImage& image, const OverviewFrame& frame, const OccupancyMap& map) {
  const GridGeometry& geometry = map.geometry;
  const double cells_per_pixel = frame.m_per_pixel / geometry.resolution_m;
  const double first_column = (frame.x_m - geometry.origin_x_m) / geometry.resolution_m;
  const double top_row = (frame.y_m - geometry.origin_y_m) / geometry.resolution_m;
  const auto left = static_cast<std::uint32_t>(frame.left_px);
  const auto top = static_cast<std::uint32_t>(frame.top_px);
  const auto width = static_cast<std::uint32_t>(frame.width_px);
  const auto height = static_cast<std::uint32_t>(frame.height_px);
  for (std::uint32_t y = 0; y < height; ++y) {
    const double row_end = top_row - cells_per_pixel * static_cast<double>(y);
    const CellSpan rows{row_end - cells_per_pixel, row_end};
    for (std::uint32_t x = 0; x < width; ++x) {
      const double column = first_column + cells_per_pixel * static_cast<double>(x);
      const PixelColour colour = colour_for(content_of(map, {column, column + cells_per_pixel}, rows), cells_per_pixel);
      std::uint8_t* const p = image.pixels.data() + 3 * (std::size_t{top + y} * image.width + left + x);
      p[0] = colour.r;
      p[1] = colour.g;
      p[2] = colour.b;
    }
  }
}

}  // namespace gdtslam
