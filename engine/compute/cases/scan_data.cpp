#include "scan_data.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

/// An axis-parallel wall between two corners, in cells.
struct Wall {
  double x0, y0, x1, y1;
};

/// Walls of the room, shares of the field's sides.
constexpr std::array<Wall, 9> kRoom{{{0.15, 0.15, 0.85, 0.15},
                                     {0.15, 0.80, 0.85, 0.80},
                                     {0.15, 0.15, 0.15, 0.80},
                                     {0.85, 0.15, 0.85, 0.80},
                                     {0.30, 0.35, 0.40, 0.35},
                                     {0.30, 0.50, 0.40, 0.50},
                                     {0.30, 0.35, 0.30, 0.50},
                                     {0.40, 0.35, 0.40, 0.50},
                                     {0.60, 0.55, 0.60, 0.80}}};

Wall room_wall(std::size_t i, CaseSize size) {
  const Wall& share = kRoom[i];
  return {share.x0 * size.width, share.y0 * size.height, share.x1 * size.width, share.y1 * size.height};
}

double sq_distance_to(const Wall& wall, double x, double y) {
  const double dx = x - std::clamp(x, wall.x0, wall.x1);
  const double dy = y - std::clamp(y, wall.y0, wall.y1);
  return dx * dx + dy * dy;
}

bool on_border(CaseSize size, std::uint32_t x, std::uint32_t y) {
  return x < 2 || y < 2 || x + 2 >= size.width || y + 2 >= size.height;
}

}  // namespace

std::vector<std::uint16_t> slow_field(CaseSize size, std::uint32_t cap, Random& random) {
  std::vector<std::uint16_t> field = noise<std::uint16_t>(size, random.bits());
  std::uint64_t value = random.below(cap + 1);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      value = std::min<std::uint64_t>(cap, value + random.below(513) - std::min<std::uint64_t>(value, 256));
      field[std::size_t{y} * size.stride + x] = static_cast<std::uint16_t>(on_border(size, x, y) ? cap : value);
    }
  }
  return field;
}

std::vector<PointCells> scattered_points(CaseSize size, std::uint32_t count, Random& random) {
  const double reach = std::min(size.width, size.height) / 3.0;
  std::vector<PointCells> points(count);
  for (std::size_t i = 1; i < points.size(); ++i) {
    points[i].x = static_cast<float>(random.uniform(-reach, reach));
    points[i].y = static_cast<float>(random.uniform(-reach, reach));
  }
  return points;
}

std::vector<std::uint16_t> room_field(CaseSize size, std::uint32_t cap, Random& random) {
  std::vector<std::uint16_t> field = noise<std::uint16_t>(size, random.bits());
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      double sq_least = 1.0e12;
      for (std::size_t i = 0; i < kRoom.size(); ++i) {
        sq_least = std::min(sq_least, sq_distance_to(room_wall(i, size), x + 0.5, y + 0.5));
      }
      const auto units = static_cast<std::uint32_t>(std::floor(256.0 * std::sqrt(sq_least) + 0.5));
      const std::uint32_t value = on_border(size, x, y) ? cap : std::min(cap, units);
      field[std::size_t{y} * size.stride + x] = static_cast<std::uint16_t>(value);
    }
  }
  return field;
}

std::vector<PointCells> room_points(CaseSize size, std::uint32_t count, const PoseCandidate& pose, Random& random) {
  const auto [sin, cos] = sin_cos(static_cast<double>(pose.theta));
  const double origin_x = anchor_cell(size.width) + static_cast<double>(pose.x);
  const double origin_y = anchor_cell(size.height) + static_cast<double>(pose.y);
  std::vector<PointCells> points(count);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Wall wall = room_wall(i % kRoom.size(), size);
    const double share = random.uniform(0.0, 1.0);
    const double dx = wall.x0 + share * (wall.x1 - wall.x0) - origin_x;
    const double dy = wall.y0 + share * (wall.y1 - wall.y0) - origin_y;
    points[i] = {static_cast<float>(cos * dx + sin * dy), static_cast<float>(cos * dy - sin * dx)};
  }
  return points;
}

std::vector<CaseBuffer> scene_buffers(CaseSize size, bool room, std::uint32_t cap, std::uint32_t count,
                                      Random& random) {
  const auto field = room ? room_field(size, cap, random) : slow_field(size, cap, random);
  const auto points = room ? room_points(size, count, kTruePose, random) : scattered_points(size, count, random);
  return {grid_buffer(size, field), list_buffer(points)};
}

void make_subnormal(std::vector<PoseCandidate>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const float value = i % 2 == 0 ? kSubnormal : -kSubnormal;
    poses[i].x = i % 7 % 4 == 0 ? value : poses[i].x;
    poses[i].y = i % 7 % 4 < 2 ? -value : poses[i].y;
    poses[i].theta = i % 7 < 4 ? value : poses[i].theta;
  }
}

std::vector<std::uint16_t> in_strips(CaseSize size, const std::vector<std::uint16_t>& values,
                                     const FieldLayout& layout) {
  constexpr std::uint16_t kNoCell = 0xA5C3;
  std::vector<std::uint16_t> cells(std::size_t{(size.width - 1) / kStripWidth + 1} * layout.strip, kNoCell);
  for (std::size_t y = 0; y < size.height; ++y) {
    for (std::size_t x = 0; x < size.width; ++x) {
      const auto cell = static_cast<std::uint16_t>(values[y * size.stride + x] ^ layout.blank);
      cells[layout.place(x, y)] = cell;
      if (x > 0 && x % kStripWidth == 0) cells[layout.place(x - 1, y) + 1] = cell;
    }
  }
  return cells;
}

void lay_in_strips(CaseSize size, std::uint32_t blank, PoseCost::Params& params, CaseBuffer& field) {
  std::vector<std::uint16_t> values(field.content.size() / sizeof(std::uint16_t));
  std::memcpy(values.data(), field.content.data(), field.content.size());
  const FieldLayout layout = strips_for(size, blank);
  params.stride = layout.stride;
  params.strip = layout.strip;
  params.blank = layout.blank;
  field = list_buffer(in_strips(size, values, layout));
}

}  // namespace gdtslam
