// Grid of the cells that beams crossed or ended in along a stretch of the path. A loop is refused if its walls would
// stand in cells that the robot looked through. Frame: that of the points given. Thread-safe to read. Cost: linear in
// the length of the beams; 10 bytes a cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// A beam: position of the laser and of its return.
struct Beam {
  Point2 from;
  Point2 to;
};

/// A wall in a cell: one point of it, its normal toward the robot, and the keyframe of the group that saw it.
struct WallPoint {
  Point2 point;
  Point2 normal;
  std::size_t keyframe = 0;
};

class FreeSpace {
 public:
  static constexpr double kCell_m = 0.1;

  /// Takes the beams and the wall points among their returns; the first wall point of each cell counts.
  FreeSpace(std::span<const Beam> beams, std::span<const WallPoint> walls);

  /// True if several beams crossed the cell and no return lies in it or within two cells.
  [[nodiscard]] bool is_free(const Point2& point) const;
  /// True if several beams crossed the cell or a return lies in it.
  [[nodiscard]] bool is_known(const Point2& point) const;
  /// Calls visit(wall) for the walls within two cells.
  template <class Visit>
  void visit_walls_near(const Point2& point, const Visit& visit) const;
  [[nodiscard]] std::size_t bytes() const { return cells_.size() * sizeof(Cell) + walls_.size() * sizeof(WallPoint); }
  /// The wall points, one a cell.
  [[nodiscard]] std::span<const WallPoint> walls() const { return walls_; }

 private:
  static constexpr std::int32_t kNone = -1;
  struct Cell {
    std::uint16_t crossed = 0;
    std::uint16_t hit = 0;
    std::int32_t wall = kNone;
  };
  static constexpr std::size_t kOutside = static_cast<std::size_t>(-1);

  void size_for(std::span<const Beam> beams);
  void cross(const Beam& beam);
  [[nodiscard]] std::size_t cell_index(const Point2& point) const;
  [[nodiscard]] const Cell* cell_at(std::int64_t x, std::int64_t y) const;
  static std::int64_t grid_coordinate(double coordinate_m);

  std::int64_t left_ = 0;
  std::int64_t bottom_ = 0;
  std::int64_t width_ = 0;
  std::int64_t height_ = 0;
  std::vector<Cell> cells_;
  std::vector<WallPoint> walls_;
};

template <class Visit>
void FreeSpace::visit_walls_near(const Point2& point, const Visit& visit) const {
  constexpr std::int64_t kReach = 2;
  const std::int64_t x = grid_coordinate(point.x());
  const std::int64_t y = grid_coordinate(point.y());
  for (std::int64_t j = y - kReach; j <= y + kReach; ++j) {
    for (std::int64_t i = x - kReach; i <= x + kReach; ++i) {
      const Cell* cell = cell_at(i, j);
      if (cell != nullptr && cell->wall != kNone) visit(walls_[static_cast<std::size_t>(cell->wall)]);
    }
  }
}

}  // namespace gdtslam
