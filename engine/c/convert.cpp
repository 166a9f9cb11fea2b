#include "convert.hpp"

#include <cmath>
#include <span>

#include "engine/io/sha256.hpp"
#include "guard.hpp"

namespace gdtslam::c {
namespace {

constexpr std::size_t kMostBeams = std::size_t{1} << 30U;

std::uint8_t to_pixel(CellState state) {
  switch (state) {
    case CellState::kFree:
      return GDTSLAM_FREE;
    case CellState::kOccupied:
      return GDTSLAM_OCCUPIED;
    default:
      return GDTSLAM_UNKNOWN;
  }
}

std::size_t cell_bytes(const gdtslam_grid& grid) { return grid.cells.index() == 0 ? 2 : 1; }

const void* cell_data(const gdtslam_grid& grid) {
  return std::visit([](const auto& cells) { return static_cast<const void*>(cells.data()); }, grid.cells);
}

}  // namespace

std::vector<gdtslam_stamped_pose> to_c(const Trajectory& trajectory) {
  std::vector<gdtslam_stamped_pose> poses;
  poses.reserve(trajectory.size());
  for (const StampedPose& pose : trajectory) poses.push_back(to_c(pose));
  return poses;
}

ScanRecord to_scan_record(const gdtslam_scan* scan, const char* what) {
  const gdtslam_scan given = read_struct(scan, GDTSLAM_SIZE_WITH(gdtslam_scan, range_count), what);
  if (given.range_count > kMostBeams) {
    throw InputError(std::string(what) + ": a scan of " + std::to_string(given.range_count) + " beams");
  }
  if (given.range_count > 0) require(given.ranges_m, (std::string(what) + ": ranges_m").c_str());
  ScanRecord record;
  LaserScan& s = record.scan;
  s.stamp_s = given.stamp_s;
  s.first_bearing_rad = given.first_bearing_rad;
  s.bearing_step_rad = given.bearing_step_rad;
  s.max_range_m = given.max_range_m;
  s.first_beam_after_s = given.first_beam_after_s;
  s.beam_period_s = given.beam_period_s;
  s.T_base_laser = to_pose(given.T_base_laser);
  s.ranges_m.assign(given.ranges_m, given.ranges_m + given.range_count);
  if (given.has_speed != 0) s.speed = {given.speed.x_m, given.speed.y_m, given.speed.theta_rad};
  if (given.has_odometry != 0) record.T_odom_base = to_pose(given.T_odom_base);
  record.laser = static_cast<std::size_t>(given.laser);
  for (const double value :
       {s.stamp_s, s.first_bearing_rad, s.bearing_step_rad, s.max_range_m, s.first_beam_after_s, s.beam_period_s}) {
    if (!std::isfinite(value)) throw InputError(std::string(what) + ": a number that describes it is not finite");
  }
  if (!s.T_base_laser.is_finite()) throw InputError(std::string(what) + ": T_base_laser is not finite");
  if (s.speed && !s.speed->allFinite()) throw InputError(std::string(what) + ": speed is not finite");
  return record;
}

gdtslam_scan to_c(const ScanRecord& record) {
  const LaserScan& s = record.scan;
  const Eigen::Vector3d speed = s.speed.value_or(Eigen::Vector3d::Zero());
  return {.size = 0,
          .stamp_s = s.stamp_s,
          .first_bearing_rad = s.first_bearing_rad,
          .bearing_step_rad = s.bearing_step_rad,
          .ranges_m = s.ranges_m.data(),
          .range_count = s.ranges_m.size(),
          .max_range_m = s.max_range_m,
          .T_base_laser = to_c(s.T_base_laser),
          .first_beam_after_s = s.first_beam_after_s,
          .beam_period_s = s.beam_period_s,
          .has_odometry = record.T_odom_base ? 1 : 0,
          .has_speed = s.speed ? 1 : 0,
          .T_odom_base = to_c(record.T_odom_base.value_or(Pose2())),
          .speed = {speed.x(), speed.y(), speed.z()},
          .laser = record.laser};
}

std::unique_ptr<gdtslam_grid> make_grid(const DistanceFieldRows& field) {
  const auto width = static_cast<std::size_t>(field.geometry.width);
  std::vector<std::uint16_t> cells(field.geometry.cell_count());
  for (std::int32_t y = 0; y < field.geometry.height; ++y) {
    field.read(y, std::span(cells).subspan(static_cast<std::size_t>(y) * width, width));
  }
  auto grid = std::make_unique<gdtslam_grid>();
  grid->geometry = field.geometry;
  grid->cells = std::move(cells);
  grid->cap = field.cap;
  return grid;
}

std::unique_ptr<gdtslam_grid> make_grid(const OccupancyMap& map) {
  std::vector<std::uint8_t> cells;
  cells.reserve(map.geometry.cell_count());
  std::vector<CellState> row(static_cast<std::size_t>(map.geometry.width));
  for (std::int32_t y = 0; y < map.geometry.height; ++y) {
    map.read_row(y, row);
    for (const CellState state : row) cells.push_back(to_pixel(state));
  }
  auto grid = std::make_unique<gdtslam_grid>();
  grid->geometry = map.geometry;
  grid->cells = std::move(cells);
  return grid;
}

}  // namespace gdtslam::c

using namespace gdtslam::c;

gdtslam_status gdtslam_grid_look(const gdtslam_grid* grid, gdtslam_grid_view* view, gdtslam_error* error) {
  return guarded(error, [&] {
    require(grid, "gdtslam_grid_look: grid");
    const gdtslam::GridGeometry& g = grid->geometry;
    const std::size_t bytes = cell_bytes(*grid);
    write_struct<gdtslam_grid_view>({.size = 0,
                                     .cells = cell_data(*grid),
                                     .row_bytes = bytes * static_cast<std::size_t>(g.width),
                                     .cell_bytes = bytes,
                                     .width = g.width,
                                     .height = g.height,
                                     .resolution_m = g.resolution_m,
                                     .origin_x_m = g.origin_x_m,
                                     .origin_y_m = g.origin_y_m,
                                     .cap = grid->cap},
                                    view, "gdtslam_grid_look: view");
  });
}

const char* gdtslam_grid_sha256(const gdtslam_grid* grid) {
  if (grid == nullptr || grid->cells.index() != 0) return "";
  const gdtslam_status status = guarded(nullptr, [grid] {
    std::call_once(grid->hashed, [grid] {
      const gdtslam::DistanceFieldView view{grid->geometry, static_cast<std::size_t>(grid->geometry.width),
                                            std::get<0>(grid->cells), static_cast<std::uint16_t>(grid->cap)};
      grid->sha256 = gdtslam::sha256_of(gdtslam::rows_of(view));
    });
  });
  return status == GDTSLAM_OK ? grid->sha256.c_str() : "";
}

void gdtslam_grid_free(gdtslam_grid* grid) { delete grid; }
