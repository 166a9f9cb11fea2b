#include "map_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace gdtslam {
namespace {

using page_sizes::kHeading;
using page_sizes::kInset;
using page_sizes::kMargin;
using page_sizes::kWidth;

constexpr double kTallest = 1100.0;
constexpr double kLeastTall = 260.0;
constexpr double kAround_m = 1.0;    // of poses
constexpr double kImageScale = 2.0;  // pixels of the map's image for each of the drawing
constexpr Colour kWall = colour_for(0x8e949c);
constexpr double kNoWall = 512.0;  // 1/256 cell: an obstacle is drawn in full up to kWallOfField, and to nothing here

/// Where all but a few of the counts lie: the first and the last that count.
std::pair<std::size_t, std::size_t> span_of(const std::vector<std::uint64_t>& counts) {
  constexpr double kStray = 0.002;  // of all obstacles, at either end: single returns far outside stretch no picture
  const auto total = static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
  const auto most = static_cast<std::uint64_t>(kStray * total);
  std::size_t first = 0;
  for (std::uint64_t sum = counts[first]; sum <= most && first + 1 < counts.size();) sum += counts[++first];
  std::size_t last = counts.size() - 1;
  for (std::uint64_t sum = counts[last]; sum <= most && last > first;) sum += counts[--last];
  return {first, last};
}

/// The part of the map that is worth a picture, metres.
void frame_map(const DistanceFieldView& field, Point2& low, Point2& high) {
  const GridGeometry& grid = field.geometry;
  std::vector<std::uint64_t> columns(static_cast<std::size_t>(grid.width));
  std::vector<std::uint64_t> rows(static_cast<std::size_t>(grid.height));
  for (std::int32_t y = 0; y < grid.height; ++y) {
    for (std::int32_t x = 0; x < grid.width; ++x) {
      if (field.at({x, y}) > kWallOfField) continue;
      ++columns[static_cast<std::size_t>(x)];
      ++rows[static_cast<std::size_t>(y)];
    }
  }
  const auto [left, right] = span_of(columns);
  const auto [bottom, top] = span_of(rows);
  const Point2 around(kAround_m, kAround_m);
  low = grid.centre_of({static_cast<std::int32_t>(left), static_cast<std::int32_t>(bottom)}) - around;
  high = grid.centre_of({static_cast<std::int32_t>(right), static_cast<std::int32_t>(top)}) + around;
}

// The nearest obstacle of all cells under a pixel, so that walls stay whole however small the map is drawn.
std::uint16_t least_under(const DistanceFieldView& field, const Point2& from_m, const Point2& to_m) {
  const CellIndex a = field.geometry.cell_of(from_m);
  const CellIndex b = field.geometry.cell_of(to_m);
  std::uint16_t least = field.cap;
  for (std::int32_t y = std::max(a.y, 0); y <= std::min(b.y, field.geometry.height - 1); ++y) {
    for (std::int32_t x = std::max(a.x, 0); x <= std::min(b.x, field.geometry.width - 1); ++x) {
      least = std::min(least, field.at({x, y}));
    }
  }
  return least;
}

}  // namespace

MapView view_of_map(const DistanceFieldView& field, std::span<const Point2> places_m) {
  Point2 low = Point2::Zero();
  Point2 high = Point2::Zero();
  frame_map(field, low, high);
  const Point2 around(kAround_m, kAround_m);
  for (const Point2& place : places_m) {
    low = low.cwiseMin(place - around);
    high = high.cwiseMax(place + around);
  }
  MapView view;
  view.card = {{kMargin, kMargin + kHeading}, kWidth - 2.0 * kMargin, 0.0};
  view.centre_m = 0.5 * (low + high);
  const double wide = view.card.width - 2.0 * kInset;
  view.pixels_per_m = std::min(wide / (high.x() - low.x()), (kTallest - 2.0 * kInset) / (high.y() - low.y()));
  view.card.height = std::max(kLeastTall, view.pixels_per_m * (high.y() - low.y()) + 2.0 * kInset);
  return view;
}

void draw_walls(Canvas& canvas, const MapView& view, const DistanceFieldView& field) {
  auto image = std::make_shared<RgbaImage>(static_cast<std::uint32_t>(kImageScale * view.card.width),
                                           static_cast<std::uint32_t>(kImageScale * view.card.height));
  for (std::uint32_t v = 0; v < image->height; ++v) {
    for (std::uint32_t u = 0; u < image->width; ++u) {
      const Point2 upper_left = view.card.corner + Point2(u, v) / kImageScale;
      const Point2 lower_right = upper_left + Point2(1.0, 1.0) / kImageScale;
      const Point2 from = view.back({upper_left.x(), lower_right.y()});
      const Point2 to = view.back({lower_right.x(), upper_left.y()});
      const double value = least_under(field, from, to);
      const double share = std::clamp((kNoWall - value) / (kNoWall - kWallOfField), 0.0, 1.0);
      std::uint8_t* const pixel = image->at(u, v);
      pixel[0] = kWall.red;
      pixel[1] = kWall.green;
      pixel[2] = kWall.blue;
      pixel[3] = static_cast<std::uint8_t>(std::lround(255.0 * share));
    }
  }
  canvas.picture(view.card.corner, view.card.width, view.card.height, std::move(image));
}

}  // namespace gdtslam
