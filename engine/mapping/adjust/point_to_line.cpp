#include "point_to_line.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/compute/kernels/host_kernels.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/compute/backend.hpp"

namespace gdtslam {
namespace {

constexpr float kFarAway_m = 1.0e15F;  // of the points that fill up a scan; the square is finite
constexpr double kSameFace = 0.8;      // least cosine between normals
constexpr double kKernelShare = 0.3;   // scale of the kernel, as a share of the gate

// Smaller ones become 0: their products could be subnormal, which a device may treat as 0 (docs/numerics.md).
float without_traces(double value) {
  constexpr double kTrace = 1.0e-15;
  return std::fabs(value) < kTrace ? 0.0F : static_cast<float>(value);
}

}  // namespace

// Directions up to half a beam beyond the first and the last are in view.
LineScan::LineScan(std::span<const SurfacePoint> surface) : size_(surface.size()) {
  const std::size_t count = std::max<std::size_t>(size_, PointToLine::kCandidates);
  values_.resize(4 * count);
  std::fill_n(values_.begin(), 2 * count, kFarAway_m);
  for (std::size_t i = 0; i < size_; ++i) {
    const SurfacePoint& p = surface[i];
    values_[i] = p.x_m;
    values_[count + i] = p.y_m;
    values_[2 * count + i] = without_traces(static_cast<double>(p.normal_x));
    values_[3 * count + i] = without_traces(static_cast<double>(p.normal_y));
  }
  constexpr std::size_t kMost = std::numeric_limits<std::uint16_t>::max();
  std::size_t at = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    const float begin = 4.0F * static_cast<float>(bin) / static_cast<float>(PointToLine::kBins) - 2.0F;
    while (at < size_ && surface[at].direction < begin) ++at;
    bins_[bin] = static_cast<std::uint16_t>(std::min(at, kMost));
  }
  if (size_ < 2) return;
  low_ = surface[0].direction - 0.5F * (surface[1].direction - surface[0].direction);
  high_ = surface[size_ - 1].direction + 0.5F * (surface[size_ - 1].direction - surface[size_ - 2].direction);
}

PointToLine::Scan LineScan::view() const {
  return {values_.data(), static_cast<std::uint32_t>(values_.size() / 4), bins_.data(), low_, high_};
}

TakenShare::TakenShare(std::size_t size, std::size_t wanted)
    : every(static_cast<std::uint32_t>(std::max<std::size_t>(1, size / wanted))),
      count(static_cast<std::uint32_t>((size + every - 1) / every)) {}

PointToLine::Params line_params(const LineGate& gate) {
  const double kernel_m = kKernelShare * gate.most_m;
  return {.gate_m2 = static_cast<float>(gate.most_m * gate.most_m),
          .per_kernel_m2 = static_cast<float>(1.0 / (kernel_m * kernel_m)),
          .least_cosine = static_cast<float>(kSameFace)};
}

PointToLine::Pose line_pose(const Pose2& T_fixed_moving) {
  const SinCos<double> turn = sin_cos(T_fixed_moving.theta_rad);
  return {.x = without_traces(T_fixed_moving.x_m),
          .y = without_traces(T_fixed_moving.y_m),
          .sin = without_traces(turn.sin),
          .cos = without_traces(turn.cos)};
}

LineEquations to_equations(const PointToLine::Sums& sums) {
  std::array<double, PointToLine::kSums> wide{};
  std::copy(sums.begin(), sums.end(), wide.begin());
  const auto& [xx, xy, xt, yy, yt, tt, x, y, t, weight, cost_m2] = wide;
  return {.information = {{xx, xy, xt, xy, yy, yt, xt, yt, tt}},
          .gradient = {x, y, t},
          .weight = weight,
          .cost_m2 = cost_m2};
}

LineEquations line_equations(const LineScan& fixed, const LineScan& moving, const Pose2& T_fixed_moving,
                             const LineGate& gate) {
  const TakenShare taken(moving.size(), gate.points);
  const PointToLine::Params params = line_params(gate);
  const PointToLine::Pose pose = line_pose(T_fixed_moving);
  std::vector<std::int32_t> found(taken.count);
  find_lines_host(best_isa(), params, pose, fixed.view(), moving.view(), taken.every, found);
  return to_equations(line_slope_host(best_isa(), params, pose, fixed.view(), moving.view(), taken.every, found));
}

}  // namespace gdtslam
