#include "objective.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "engine/compute/device_memory.hpp"
#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/host_kernels.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kSmallBatch = 64;  // below this a dispatch costs more than it gains

// A scan fits about as well if the mean distance of its points is larger by at most this; farther points are capped.
constexpr double kAboutAsWell = 1.3;
constexpr double kAsWell_m = 0.003;
constexpr double kFarthest_m = 0.3;

}  // namespace

Objective::Objective(const GlobalField& map, Interpolation interpolation, CostForm form)
    : backend_(&map.backend()), map_(&map), interpolation_(interpolation), form_(form) {}

PoseCost::Params pose_cost_params(const GlobalField& map, CellIndex anchor_cell, std::size_t points, std::uint32_t cap,
                                  Interpolation interpolation, CostForm form) {
  const CellBox& stored = map.stored();
  const CellOffset anchor = anchor_cell - stored.min;
  return {.width = static_cast<std::uint32_t>(stored.width()),
          .height = static_cast<std::uint32_t>(stored.height()),
          .stride = map.layout().stride,
          .strip = map.layout().strip,
          .blank = map.layout().blank,
          .anchor_x = anchor.dx,
          .anchor_y = anchor.dy,
          .point_count = static_cast<std::uint32_t>(points),
          .cap = cap,
          .interpolation = interpolation,
          .form = form};
}

// The arithmetic of PriorParams.
std::uint32_t Objective::prior_cost(const CellPose& pose) const {
  const float dx = pose.x - prior_.mean_x;
  const float dy = pose.y - prior_.mean_y;
  const float dt = pose.theta - prior_.mean_theta;
  const auto limited = [this](float cost) { return cost < prior_.limit ? cost : prior_.limit; };
  return static_cast<std::uint32_t>(limited((dx * dx + dy * dy) * prior_.weight_xy) +
                                    limited((dt * dt) * prior_.weight_theta));
}

PolishedPose Objective::descend(const CellPose& start, const PoseSimplex::Params& walk) {
  PolishedPose pose{start.x, start.y, start.theta};
  pose_simplex_host(backend_->host_isa(), walk, map_->memory().data(), points_.data(), &pose, 1);
  evaluations_ += pose.evaluations;
  return pose;
}

void Objective::upload(Buffer& buffer, std::span<const std::byte> bytes) {
  reserve_on(*backend_, buffer, bytes.size());
  backend_->upload(buffer, bytes);
}

void Objective::descend(PoseDescent::Params descent, std::span<PolishedPose> poses, std::span<std::uint16_t> values) {
  descent.grid = params(Interpolation::kBilinear, points_.size());
  descent.prior = prior_;
  const auto count = static_cast<std::uint32_t>(poses.size());
  assert(values.size() == poses.size() * PoseDescent::row_of(descent.grid.point_count));
  if (!map_->memory().empty()) {
    pose_descent_host(backend_->host_isa(), descent, map_->memory().data(), points_.data(), poses.data(), values.data(),
                      count);
  } else {
    upload(point_buffer_, std::as_bytes(points_));
    upload(pose_buffer_, std::as_bytes(poses));
    reserve_on(*backend_, value_buffer_, values.size_bytes());
    run<PoseDescent>(*backend_, descent, {count, 1, 1}, map_->buffer(), point_buffer_, pose_buffer_, value_buffer_);
    const PendingDownload ends = backend_->start_download(pose_buffer_, poses.size_bytes());
    const PendingDownload under = backend_->start_download(value_buffer_, values.size_bytes());
    backend_->finish_download(ends, std::as_writable_bytes(poses));
    backend_->finish_download(under, std::as_writable_bytes(values));
  }
  for (const PolishedPose& pose : poses) evaluations_ += pose.evaluations;
}

void Objective::evaluate(std::span<const CellPose> poses, std::span<std::uint32_t> costs, Interpolation interpolation) {
  assert(poses.size() == costs.size());
  evaluations_ += poses.size();
  candidates_.clear();
  for (const CellPose& pose : poses) candidates_.push_back({pose.x, pose.y, pose.theta, prior_cost(pose)});
  const PoseCost::Params p = params(interpolation, points_.size());
  if (poses.size() <= kSmallBatch && !map_->memory().empty()) {
    pose_cost_host(backend_->host_isa(), p, map_->memory().data(), points_.data(), candidates_.data(),
                   static_cast<std::uint32_t>(poses.size()), costs.data());
    return;
  }
  upload(point_buffer_, std::as_bytes(points_));
  upload(candidate_buffer_, std::as_bytes(std::span(candidates_)));
  reserve_on(*backend_, cost_buffer_, costs.size_bytes());
  run<PoseCost>(*backend_, p, {static_cast<std::uint32_t>(poses.size()), 1, 1}, map_->buffer(), point_buffer_,
                candidate_buffer_, cost_buffer_);
  backend_->download(cost_buffer_, std::as_writable_bytes(costs));
}

std::uint32_t Objective::evaluate(const CellPose& pose) {
  ++evaluations_;
  const PoseCandidate candidate{pose.x, pose.y, pose.theta, prior_cost(pose)};
  std::uint32_t cost = 0;
  pose_cost_host(backend_->host_isa(), params(interpolation_, points_.size()), map_->memory().data(), points_.data(),
                 &candidate, 1, &cost);
  return cost;
}

void Objective::residuals(const CellPose& pose, std::span<const PointCells> points,
                          std::span<std::uint16_t> values) const {
  // The two outermost rows and columns hold the cap, so a point off the map reads it at the nearest of them.
  point_values_host(backend_->host_isa(), params(Interpolation::kNearest, points.size()), map_->memory().data(),
                    points.data(), {.x = pose.x, .y = pose.y, .theta = pose.theta}, values.data());
}

CellPose Objective::to_cells(const Pose2& T_map_base) const {
  const double resolution_m = map_->geometry().resolution_m;
  return {static_cast<float>(T_map_base.x_m / resolution_m - anchor_.x),
          static_cast<float>(T_map_base.y_m / resolution_m - anchor_.y),
          static_cast<float>(wrap_angle(T_map_base.theta_rad))};
}

Pose2 Objective::to_metres(const CellPose& pose) const {
  return pose_in_metres(pose, anchor_, map_->geometry().resolution_m);
}

std::array<double, 2> mean_distances_m(const GlobalField& map, std::span<const PointCells> points,
                                       const std::array<Pose2, 2>& poses, double farthest_m) {
  const double unit_m = map.geometry().resolution_m / kFieldOne;
  Objective objective(map, Interpolation::kBilinear, CostForm::kDistance);
  objective.set_anchor(map_cell_at(poses.front().translation(), map.geometry().resolution_m));
  objective.set_points(points);
  objective.set_cap(std::min<std::uint32_t>(map.cap(), static_cast<std::uint32_t>(std::lround(farthest_m / unit_m))));
  const std::array<CellPose, 2> there{objective.to_cells(poses[0]), objective.to_cells(poses[1])};
  std::array<std::uint32_t, 2> costs{};
  objective.evaluate(there, costs);
  const double unit = unit_m / static_cast<double>(std::max<std::size_t>(1, points.size()));
  return {unit * costs[0], unit * costs[1]};
}

bool fits_about_as_well(const GlobalField& map, std::span<const PointCells> points, const Pose2& pose,
                        const Pose2& matched) {
  const auto [there, here] = mean_distances_m(map, points, {matched, pose}, kFarthest_m);
  return here <= kAboutAsWell * there + kAsWell_m;
}

}  // namespace gdtslam
