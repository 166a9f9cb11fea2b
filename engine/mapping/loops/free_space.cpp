#include "free_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gdtslam {
namespace {

constexpr std::uint16_t kMostCounted = std::numeric_limits<std::uint16_t>::max();
constexpr std::uint16_t kFewestCrossings = 3;
constexpr std::int64_t kBesideReturn = 2;  // cells around a return that do not count as free
constexpr int kCellsBeforeReturn = 2;      // cells before a return are not counted: a wall is as thick as its noise

void count(std::uint16_t& counter) {
  if (counter < kMostCounted) ++counter;
}

}  // namespace

std::int64_t FreeSpace::grid_coordinate(double coordinate_m) {
  return static_cast<std::int64_t>(std::floor(coordinate_m / kCell_m));
}

FreeSpace::FreeSpace(std::span<const Beam> beams, std::span<const WallPoint> walls) {
  size_for(beams);
  for (const Beam& beam : beams) cross(beam);
  for (const WallPoint& wall : walls) {
    const std::size_t index = cell_index(wall.point);
    if (index == kOutside || cells_[index].wall != kNone) continue;
    cells_[index].wall = static_cast<std::int32_t>(walls_.size());
    walls_.push_back(wall);
  }
}

// Leaves a margin of one cell on each side.
void FreeSpace::size_for(std::span<const Beam> beams) {
  if (beams.empty()) return;
  double low_x = beams.front().from.x();
  double high_x = low_x;
  double low_y = beams.front().from.y();
  double high_y = low_y;
  for (const Beam& beam : beams) {
    for (const Point2& end : {beam.from, beam.to}) {
      low_x = std::min(low_x, end.x());
      high_x = std::max(high_x, end.x());
      low_y = std::min(low_y, end.y());
      high_y = std::max(high_y, end.y());
    }
  }
  left_ = grid_coordinate(low_x) - 1;
  bottom_ = grid_coordinate(low_y) - 1;
  width_ = grid_coordinate(high_x) - left_ + 2;
  height_ = grid_coordinate(high_y) - bottom_ + 2;
  cells_.resize(static_cast<std::size_t>(width_ * height_));
}

std::size_t FreeSpace::cell_index(const Point2& point) const {
  const std::int64_t x = grid_coordinate(point.x()) - left_;
  const std::int64_t y = grid_coordinate(point.y()) - bottom_;
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return kOutside;
  return static_cast<std::size_t>(y * width_ + x);
}

const FreeSpace::Cell* FreeSpace::cell_at(std::int64_t x, std::int64_t y) const {
  const std::int64_t column = x - left_;
  const std::int64_t row = y - bottom_;
  if (column < 0 || row < 0 || column >= width_ || row >= height_) return nullptr;
  return &cells_[static_cast<std::size_t>(row * width_ + column)];
}

// Walks in steps of a cell; each cell counts once a beam. Both ends lie in the grid, whose cells are counted from its
// corner, so no coordinate is negative.
void FreeSpace::cross(const Beam& beam) {
  const double x = beam.from.x() / kCell_m - static_cast<double>(left_);
  const double y = beam.from.y() / kCell_m - static_cast<double>(bottom_);
  const double dx = (beam.to.x() - beam.from.x()) / kCell_m;
  const double dy = (beam.to.y() - beam.from.y()) / kCell_m;
  const double length = std::sqrt(dx * dx + dy * dy);
  const auto steps = static_cast<int>(length) - kCellsBeforeReturn;
  const double step_x = length > 0.0 ? dx / length : 0.0;
  const double step_y = length > 0.0 ? dy / length : 0.0;
  const auto index = [this](double column, double row) {
    return static_cast<std::size_t>(static_cast<std::int64_t>(row) * width_ + static_cast<std::int64_t>(column));
  };
  std::size_t last = kOutside;
  for (int i = 0; i < steps; ++i) {
    const std::size_t here = index(x + i * step_x, y + i * step_y);
    if (here != last) count(cells_[here].crossed);
    last = here;
  }
  count(cells_[index(x + dx, y + dy)].hit);
}

bool FreeSpace::is_free(const Point2& point) const {
  const std::int64_t x = grid_coordinate(point.x());
  const std::int64_t y = grid_coordinate(point.y());
  const Cell* here = cell_at(x, y);
  if (here == nullptr || here->crossed < kFewestCrossings) return false;
  for (std::int64_t j = y - kBesideReturn; j <= y + kBesideReturn; ++j) {
    for (std::int64_t i = x - kBesideReturn; i <= x + kBesideReturn; ++i) {
      const Cell* cell = cell_at(i, j);
      if (cell != nullptr && cell->hit > 0) return false;
    }
  }
  return true;
}

bool FreeSpace::is_known(const Point2& point) const {
  const Cell* cell = cell_at(grid_coordinate(point.x()), grid_coordinate(point.y()));
  return cell != nullptr && (cell->crossed >= kFewestCrossings || cell->hit > 0);
}

}  // namespace gdtslam
