// What tests of pictures draw and how they look at a drawing: shapes by kind, pixels by colour. Nothing here asks the
// code under test where something should be.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <variant>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"

namespace gdtslam::test {

/// All shapes of one kind, in the order in which they are drawn.
template <class Kind>
std::vector<Kind> shapes_of(const Canvas& canvas) {
  std::vector<Kind> found;
  for (const Shape& shape : canvas.shapes()) {
    if (const Kind* const one = std::get_if<Kind>(&shape)) found.push_back(*one);
  }
  return found;
}

inline bool says(const Canvas& canvas, const std::string& words) {
  const auto all = shapes_of<shape::Words>(canvas);
  return std::any_of(all.begin(), all.end(),
                     [&](const shape::Words& one) { return one.text.find(words) != std::string::npos; });
}

/// Whether these are the whole words of one text.
inline bool has_words(const Canvas& canvas, const std::string& words) {
  const auto all = shapes_of<shape::Words>(canvas);
  return std::any_of(all.begin(), all.end(), [&](const shape::Words& one) { return one.text == words; });
}

/// The room of level or upright words, from text_width() and the usual height of letters.
inline DrawingArea room_for(const shape::Words& words) {
  const double width = text_width(words.text, words.lettering.size, words.lettering.is_bold);
  const double start = words.lettering.anchor == Anchor::kStart ? 0.0
                       : words.lettering.anchor == Anchor::kEnd ? 1.0
                                                                : 0.5;
  const double height = 0.76 * words.lettering.size;
  if (words.is_upright) return {words.at + Point2(-height, -(1.0 - start) * width), height, width};
  return {words.at + Point2(-start * width, -height), width, height};
}

/// Every word lies within the area, and none over another.
inline void expect_tidy(const Canvas& canvas, const DrawingArea& area, const std::string& what = "") {
  const std::vector<shape::Words> words = shapes_of<shape::Words>(canvas);
  const auto overlap = [](const DrawingArea& one, const DrawingArea& other) {
    return one.corner.x() < other.corner.x() + other.width && other.corner.x() < one.corner.x() + one.width &&
           one.corner.y() < other.corner.y() + other.height && other.corner.y() < one.corner.y() + one.height;
  };
  for (std::size_t i = 0; i < words.size(); ++i) {
    const DrawingArea one = room_for(words[i]);
    const std::string where = what + ": " + words[i].text;
    EXPECT_GE(one.corner.x(), area.corner.x() - 0.5) << where;
    EXPECT_GE(one.corner.y(), area.corner.y() - 0.5) << where;
    EXPECT_LE(one.corner.x() + one.width, area.corner.x() + area.width + 0.5) << where;
    EXPECT_LE(one.corner.y() + one.height, area.corner.y() + area.height + 0.5) << where;
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_FALSE(overlap(one, room_for(words[j]))) << where << " over " << words[j].text;
    }
  }
}
inline void expect_tidy(const Canvas& canvas, const std::string& what) {
  expect_tidy(canvas, {Point2::Zero(), canvas.width(), canvas.height()}, what);
}

/// Middle of the pixels of exactly this colour, in pixels (the middle of the upper left one is 0.5, 0.5).
struct Blob {
  Point2 centre = Point2::Zero();
  std::size_t pixels = 0;
};
inline Blob blob_of(const RgbaImage& image, Colour colour) {
  Blob blob;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::uint8_t* const pixel = image.at(x, y);
      if (pixel[0] != colour.red || pixel[1] != colour.green || pixel[2] != colour.blue || pixel[3] != 255) continue;
      blob.centre += Point2(x + 0.5, y + 0.5);
      ++blob.pixels;
    }
  }
  if (blob.pixels > 0) blob.centre /= static_cast<double>(blob.pixels);
  return blob;
}

inline double brightness(const std::uint8_t* pixel) {
  return 0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2];
}

inline OccupancyMap free_map(std::int32_t width, std::int32_t height, double resolution_m = 0.1,
                             double origin_x_m = -2.0, double origin_y_m = -1.0) {
  OccupancyMap map;
  map.geometry = {resolution_m, origin_x_m, origin_y_m, width, height};
  map.cells = CellStates(std::vector(map.geometry.cell_count(), CellState::kFree));
  return map;
}
inline void set(OccupancyMap& map, std::int32_t x, std::int32_t y, CellState state) {
  map.cells.set(
      static_cast<std::size_t>(y) * static_cast<std::size_t>(map.geometry.width) + static_cast<std::size_t>(x), state);
}
inline void set_border(OccupancyMap& map) {
  for (std::int32_t x = 0; x < map.geometry.width; ++x) {
    set(map, x, 0, CellState::kOccupied);
    set(map, x, map.geometry.height - 1, CellState::kOccupied);
  }
  for (std::int32_t y = 0; y < map.geometry.height; ++y) {
    set(map, 0, y, CellState::kOccupied);
    set(map, map.geometry.width - 1, y, CellState::kOccupied);
  }
}

/// The distance transform by its definition, in 1/256 cell.
inline FieldPicture brute_field(const GridGeometry& geometry, const std::vector<CellIndex>& obstacles,
                                std::uint16_t cap) {
  FieldPicture field{geometry, {}, cap};
  for (std::int32_t y = 0; y < geometry.height; ++y) {
    for (std::int32_t x = 0; x < geometry.width; ++x) {
      double sq_nearest = 1e9;
      for (const CellIndex& obstacle : obstacles) {
        const double dx = x - obstacle.x;
        const double dy = y - obstacle.y;
        sq_nearest = std::min(sq_nearest, dx * dx + dy * dy);
      }
      field.cells.push_back(
          static_cast<std::uint16_t>(std::min<double>(cap, std::floor(256.0 * std::sqrt(sq_nearest) + 0.5))));
    }
  }
  return field;
}

/// Two rooms with a door, seen but for a corner, and a round through them.
inline OccupancyMap two_rooms() {
  OccupancyMap map = free_map(64, 40);
  set_border(map);
  for (std::int32_t y = 0; y < 40; ++y) {
    if (y < 15 || y > 22) set(map, 30, y, CellState::kOccupied);
  }
  for (std::int32_t y = 28; y < 40; ++y) {
    for (std::int32_t x = 50; x < 64; ++x) set(map, x, y, CellState::kUnknown);
  }
  for (std::int32_t i = 0; i < 4; ++i) set(map, 12 + i, 30, CellState::kOccupied);
  return map;
}
inline std::vector<CellIndex> obstacles_of(const OccupancyMap& map) {
  std::vector<CellIndex> obstacles;
  for (std::int32_t y = 0; y < map.geometry.height; ++y) {
    for (std::int32_t x = 0; x < map.geometry.width; ++x) {
      if (map.at({x, y}) == CellState::kOccupied) obstacles.push_back({x, y});
    }
  }
  return obstacles;
}

/// The colours that a path has at its start and at its end.
inline constexpr Colour kPathStart = colour_for(0x0a42d4);
inline constexpr Colour kPathEnd = colour_for(0xf5970f);
inline PathOverlay straight_path(const Point2& from, const Point2& to) {
  PathOverlay overlay;
  overlay.trajectory = {{0.0, {from.x(), from.y(), 0.0}}, {1.0, {to.x(), to.y(), 0.0}}};
  return overlay;
}
/// A round through both rooms of two_rooms().
inline PathOverlay round_trip(double shift_m = 0.0) {
  PathOverlay overlay;
  const std::vector<Point2> corners{{-1.2, 0.0}, {0.4, 0.9}, {3.4, 0.9}, {3.6, 0.0}, {2.2, -0.4}, {-0.6, 1.6}};
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    for (int k = 0; k < 20; ++k) {
      const Point2 at = corners[i] + k / 20.0 * (corners[i + 1] - corners[i]);
      overlay.trajectory.push_back(
          {0.5 * static_cast<double>(overlay.trajectory.size()), {at.x() + shift_m, at.y() + shift_m, 0.0}});
    }
  }
  overlay.keyframes = {0, 10, 20, 30, 40, 50, 60, 70, 80, 90};
  overlay.doubtful = {35, 72};
  return overlay;
}

}  // namespace gdtslam::test
