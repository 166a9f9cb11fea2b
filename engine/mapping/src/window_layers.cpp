#include "window_layers.hpp"

#include <algorithm>

#include "device_memory.hpp"

namespace gdtslam {
namespace {

/// Of a submission: enough to keep a device busy, and few enough for a slow one to be done in a second or so.
constexpr std::uint32_t kBatchSamples = std::uint32_t{1} << 20U;

/// As PoseLattice has it.
float coordinate(float centre, std::uint32_t i, std::uint32_t count, float step) {
  const std::uint32_t middle = count / 2;
  return centre + (static_cast<float>(i) - static_cast<float>(middle)) * step;
}

}  // namespace

void WindowLayers::start(const WindowWork& work) {
  work_ = work;
  reserve_on(*backend_, *work_.candidates, layer_samples() * sizeof(PoseCandidate));
  reserve_on(*backend_, *work_.costs, layer_samples() * sizeof(std::uint32_t));
  picks_.emplace(work_.lattice.count_xy, work_.lattice.count_theta, work_.wanted);
  batch_layers_ = std::max(1U, kBatchSamples / layer_samples());
  launched_ = 0;
  under_way_.clear();
  launch_batch();
}

// The next submission is in line before the last one is waited for, so the device is never idle.
std::vector<CellPose> WindowLayers::finish() {
  for (std::uint32_t t = 0; t < work_.lattice.count_theta; ++t) {
    if (under_way_.size() <= batch_layers_) launch_batch();
    const std::span<std::uint32_t> costs = picks_->next_layer();
    backend_->finish_download(under_way_.front(), std::as_writable_bytes(costs));
    under_way_.pop_front();
    picks_->add();
  }
  std::vector<CellPose> poses;
  for (const std::uint32_t index : picks_->indices()) poses.push_back(pose_of(index));
  picks_.reset();
  return poses;
}

void WindowLayers::launch_batch() {
  const std::uint32_t end = std::min(launched_ + batch_layers_, work_.lattice.count_theta);
  if (launched_ == end) return;
  while (launched_ < end) launch_layer(launched_++);
  backend_->flush();
}

// A window of one angle: its only theta is the centre plus nothing, which is the angle of this layer.
void WindowLayers::launch_layer(std::uint32_t t) {
  PoseLattice::Params layer = work_.lattice;
  layer.centre_theta = coordinate(work_.lattice.centre_theta, t, work_.lattice.count_theta, work_.lattice.step_rad);
  layer.count_theta = 1;
  run<PoseLattice>(*backend_, layer, {layer_samples(), 1, 1}, *work_.candidates);
  run<PoseCost>(*backend_, work_.cost, {layer_samples(), 1, 1}, *work_.map, *work_.points, *work_.candidates,
                *work_.costs);
  under_way_.push_back(backend_->start_download(*work_.costs, layer_samples() * sizeof(std::uint32_t)));
}

CellPose WindowLayers::pose_of(std::uint32_t index) const {
  const PoseLattice::Params& p = work_.lattice;
  const std::uint32_t row = index / p.count_xy;
  return {coordinate(p.centre_x, index % p.count_xy, p.count_xy, p.step_cells),
          coordinate(p.centre_y, row % p.count_xy, p.count_xy, p.step_cells),
          coordinate(p.centre_theta, row / p.count_xy, p.count_theta, p.step_rad)};
}

}  // namespace gdtslam
