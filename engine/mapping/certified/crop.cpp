#include "crop.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "field.hpp"

namespace gdtslam {
namespace {

constexpr std::int32_t kEdge = 4;  // cells: patches and bilinear neighbours
// Cells: parts begin kRoom behind a multiple of kBoundAlignment and end kRoom before one, so that with the room that
// BoundFields leaves around a field for its squares they begin and end on one.
constexpr std::int32_t kRoom = 16;
// Up to here what a search saves by wider boxes and fields of minorants is less than what they cost to prepare.
constexpr double kNear_m = 0.8;
constexpr double kNear_rad = 0.5;

CellBox whole_grains(const CellBox& box) {
  const auto begin = [](std::int32_t cell) { return aligned_down(cell - kEdge - kRoom) + kRoom; };
  const auto end = [](std::int32_t cell) { return -aligned_down(-(cell + kEdge + kRoom)) - kRoom; };
  return {{begin(box.min.x), begin(box.min.y)}, {end(box.end.x), end(box.end.y)}};
}

// The cells of the box up to the cap, the cap where the map does not reach and in the two outermost rows and columns.
void copy_cells(const GlobalField& map, const CellBox& box, std::uint16_t cap, std::vector<std::uint16_t>& cells) {
  const auto width = static_cast<std::size_t>(box.width());
  cells.assign(width * static_cast<std::size_t>(box.height()), cap);
  for (std::int32_t y = box.min.y + 2; y < box.end.y - 2; ++y) {
    const auto row = std::span(cells).subspan(static_cast<std::size_t>(y - box.min.y) * width + 2, width - 4);
    map.read_row({box.min.x + 2, y}, row);
    for (std::uint16_t& cell : row) cell = std::min(cell, cap);
  }
}

}  // namespace

const CertifiedMap& CertifiedCrop::of(const GlobalField& map, const ReachedCells& reached, Isa isa) {
  const auto cap = static_cast<std::uint16_t>(std::min<std::uint32_t>(map.cap(), cap_));
  const CellBox box = whole_grains(reached.box);
  copy_cells(map, box, cap, fresh_);
  const bool is_same = prepared_ != nullptr && reached.windows == windows_ && box == box_ && fresh_ == cells_;
  if (is_same) return *prepared_;
  prepared_.reset();
  box_ = box;
  windows_ = reached.windows;
  cells_.swap(fresh_);
  const auto width = static_cast<std::uint32_t>(box.width());
  const FieldView part{.cells = cells_.data(),
                       .width = width,
                       .height = static_cast<std::uint32_t>(box.height()),
                       .stride = width,
                       .first_cell = box.min,
                       .cap = cap,
                       .resolution_m = map.geometry().resolution_m};
  prepared_ = std::make_unique<CertifiedMap>(part, isa, windows_);
  return *prepared_;
}

ReachedCells reached_from(const PoseWindow& window, std::span<const PointCells> points, double resolution_m) {
  const auto [sine, cosine] = sin_cos(window.centre.theta_rad);
  const double half_turn = std::min(0.5 * window.half_theta_rad, 1.5707963267948966);
  const double chord = 2.0 * sin_cos(half_turn).sin;  // chord that a point at range 1 covers
  double low_x = 1.0e9;
  double low_y = 1.0e9;
  double high_x = -1.0e9;
  double high_y = -1.0e9;
  for (const PointCells& point : points) {
    const double px = static_cast<double>(point.x);
    const double py = static_cast<double>(point.y);
    const double moved = chord * std::sqrt(px * px + py * py);
    const double x = cosine * px - sine * py;
    const double y = sine * px + cosine * py;
    low_x = std::min(low_x, x - moved);
    low_y = std::min(low_y, y - moved);
    high_x = std::max(high_x, x + moved);
    high_y = std::max(high_y, y + moved);
  }
  const double centre_x = window.centre.x_m / resolution_m;
  const double centre_y = window.centre.y_m / resolution_m;
  const auto cell = [](double value) {
    return static_cast<std::int32_t>(std::floor(std::clamp(value, -1.0e8, 1.0e8)));
  };
  const bool is_near = std::max(window.half_x_m, window.half_y_m) <= kNear_m && window.half_theta_rad <= kNear_rad;
  const CellBox box{{cell(centre_x + low_x - window.half_x_m / resolution_m) - 1,
                     cell(centre_y + low_y - window.half_y_m / resolution_m) - 1},
                    {cell(centre_x + high_x + window.half_x_m / resolution_m) + 2,
                     cell(centre_y + high_y + window.half_y_m / resolution_m) + 2}};
  return {box, is_near ? CertifiedMap::kNearWindows : CertifiedMap::kSmallWindows};
}

}  // namespace gdtslam
