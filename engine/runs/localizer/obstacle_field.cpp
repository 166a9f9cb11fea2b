#include "obstacle_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

// The box of all occupied cells; empty if there are none.
CellBox occupied_box(const OccupancyMap& map) {
  const GridGeometry& grid = map.geometry;
  CellBox box{{grid.width, grid.height}, {0, 0}};
  std::vector<CellState> row(static_cast<std::size_t>(grid.width));
  for (std::int32_t y = 0; y < grid.height; ++y) {
    map.read_row(y, row);
    const auto first = std::find(row.begin(), row.end(), CellState::kOccupied);
    if (first == row.end()) continue;
    const auto behind = std::find(row.rbegin(), row.rend(), CellState::kOccupied).base();
    box.min = {std::min(box.min.x, static_cast<std::int32_t>(first - row.begin())), std::min(box.min.y, y)};
    box.end = {std::max(box.end.x, static_cast<std::int32_t>(behind - row.begin())), y + 1};
  }
  return box;
}

/// The field's box in cells of the map; it may extend beyond the map.
struct FieldBox {
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t width = 0;
  std::int64_t height = 0;
};

// Beyond the radius every cell holds the cap, so the two outermost cells on each side do.
FieldBox field_box(const CellBox& occupied, std::uint32_t radius) {
  const std::int64_t margin = std::int64_t{radius} + 1;
  const FieldBox box{std::int64_t{occupied.min.x} - margin, std::int64_t{occupied.min.y} - margin,
                     std::int64_t{occupied.width()} + 2 * margin, std::int64_t{occupied.height()} + 2 * margin};
  const auto cells = static_cast<std::uint64_t>(box.width) * static_cast<std::uint64_t>(box.height);
  if (cells > kMostObstacleFieldCells) {
    throw InputError(
        fmt::format("a distance field of {} x {} cells would be too large, more than {} cells; crop the "
                    "map or scale it down",
                    box.width, box.height, kMostObstacleFieldCells));
  }
  return box;
}

/// Makes the field in bands of rows, each from the obstacles in its rows and within the radius. Two separable passes
/// [Meijster2000]: along the columns, then the least sum of squares along the rows.
class BandTransform {
 public:
  BandTransform(const OccupancyMap& map, const FieldBox& box, std::uint32_t radius)
      : map_(map), box_(box), radius_(radius), table_(distance_table(radius)) {
    states_.resize(static_cast<std::size_t>(map.geometry.width));
  }

  /// The distances of `rows` rows of the field from row `first` on.
  void make(std::int64_t first, std::int64_t rows, std::uint16_t* field) {
    const std::int64_t low = std::max<std::int64_t>(0, first - radius_);
    const std::int64_t high = std::min<std::int64_t>(box_.height, first + rows + radius_);
    const auto width = static_cast<std::size_t>(box_.width);
    columns_.assign(width * static_cast<std::size_t>(high - low), static_cast<std::uint16_t>(radius_));
    for (std::int64_t y = low; y < high; ++y) sow(y, column_distances(y - low));
    for (std::int64_t y = low + 1; y < high; ++y) spread(column_distances(y - low - 1), column_distances(y - low));
    for (std::int64_t y = high - 1; y-- > low;) spread(column_distances(y - low + 1), column_distances(y - low));
    for (std::int64_t y = first; y < first + rows; ++y) {
      fill_row(column_distances(y - low), field + static_cast<std::size_t>(y - first) * width);
    }
  }

 private:
  [[nodiscard]] std::uint16_t* column_distances(std::int64_t row) {
    return &columns_[static_cast<std::size_t>(row) * static_cast<std::size_t>(box_.width)];
  }

  // Sets the distance to zero at obstacles of a row of the field, which may lie outside of the map.
  void sow(std::int64_t y, std::uint16_t* distances) {
    const std::int64_t row = box_.y + y;
    if (row < 0 || row >= map_.geometry.height) return;
    map_.read_row(static_cast<std::int32_t>(row), states_);
    const std::int64_t begin = std::max<std::int64_t>(0, box_.x);
    const std::int64_t end = std::min<std::int64_t>(map_.geometry.width, box_.x + box_.width);
    for (std::int64_t x = begin; x < end; ++x) {
      if (states_[static_cast<std::size_t>(x)] == CellState::kOccupied) distances[x - box_.x] = 0;
    }
  }

  // Takes the distance of the previous row plus one cell if that is smaller.
  void spread(const std::uint16_t* from, std::uint16_t* to) const {
    for (std::int64_t x = 0; x < box_.width; ++x) {
      to[x] = std::min(to[x], static_cast<std::uint16_t>(from[x] + 1));
    }
  }

  // No sum exceeds the squared radius, so 16 bits suffice.
  void fill_row(const std::uint16_t* distances, std::uint16_t* field) {
    const auto width = static_cast<std::size_t>(box_.width);
    squares_.resize(width);
    best_.resize(width);
    std::transform(distances, distances + width, squares_.begin(),
                   [](std::uint32_t distance) { return static_cast<std::uint16_t>(distance * distance); });
    std::copy(squares_.begin(), squares_.end(), best_.begin());
    for (std::size_t dx = 1; dx < std::min<std::size_t>(radius_, width); ++dx) {
      const auto sq = static_cast<std::uint16_t>(dx * dx);
      const auto most = static_cast<std::uint16_t>(radius_ * radius_ - sq);
      const auto offer = [sq, most](std::uint16_t best, std::uint16_t square) {
        return std::min(best, static_cast<std::uint16_t>(std::min(square, most) + sq));
      };
      const auto shift = static_cast<std::ptrdiff_t>(dx);
      std::transform(best_.begin() + shift, best_.end(), squares_.begin(), best_.begin() + shift, offer);
      std::transform(best_.begin(), best_.end() - shift, squares_.begin() + shift, best_.begin(), offer);
    }
    std::transform(best_.begin(), best_.end(), field, [this](std::uint16_t square) { return table_[square]; });
  }

  const OccupancyMap& map_;
  FieldBox box_;
  std::uint32_t radius_;
  std::vector<std::uint16_t> table_;
  std::vector<CellState> states_;
  std::vector<std::uint16_t> columns_;  // distances along the columns, at most the radius
  // One row: squared distances along the columns, and the least sums.
  std::vector<std::uint16_t> squares_;
  std::vector<std::uint16_t> best_;
};

}  // namespace

std::uint32_t obstacle_radius(double truncation_m, double resolution_m) {
  constexpr double kLeast = 4.0;
  constexpr double kMost = 255.0;
  return static_cast<std::uint32_t>(std::lround(std::clamp(truncation_m / resolution_m, kLeast, kMost)));
}

ObstacleFieldSize obstacle_field_size(const OccupancyMap& map, std::uint32_t radius_cells) {
  const CellBox occupied = occupied_box(map);
  if (occupied.empty()) return {};
  const FieldBox box = field_box(occupied, radius_cells);
  return {static_cast<std::uint64_t>(box.width), static_cast<std::uint64_t>(box.height)};
}

DistanceFieldFile obstacle_field(const OccupancyMap& map, std::uint32_t radius_cells, std::int32_t band_rows) {
  assert(radius_cells >= 1 && radius_cells <= 255 && band_rows >= 1);
  const GridGeometry& grid = map.geometry;
  DistanceFieldFile field;
  field.cap = field_cap(radius_cells);
  field.geometry = {grid.resolution_m, grid.origin_x_m, grid.origin_y_m, 0, 0};
  const CellBox occupied = occupied_box(map);
  if (occupied.empty()) return field;
  const FieldBox box = field_box(occupied, radius_cells);
  field.geometry = {grid.resolution_m, grid.origin_x_m + static_cast<double>(box.x) * grid.resolution_m,
                    grid.origin_y_m + static_cast<double>(box.y) * grid.resolution_m,
                    static_cast<std::int32_t>(box.width), static_cast<std::int32_t>(box.height)};
  field.cells.resize(field.geometry.cell_count());
  BandTransform bands(map, box, radius_cells);
  for (std::int64_t first = 0; first < box.height; first += band_rows) {
    const std::int64_t rows = std::min<std::int64_t>(band_rows, box.height - first);
    bands.make(first, rows, field.cells.data() + first * box.width);
  }
  return field;
}

}  // namespace gdtslam
