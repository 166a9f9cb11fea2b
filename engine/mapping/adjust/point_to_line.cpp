#include "point_to_line.hpp"

#include <algorithm>
#include <limits>

#include "engine/compute/kernels/host_kernels.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/compute/backend.hpp"

namespace gdtslam {
namespace {

constexpr float kFarAway_m = 1.0e15F;  // of the points that fill up a scan; the square is finite
constexpr double kSameFace = 0.8;      // least cosine between normals
constexpr double kKernelShare = 0.3;   // scale of the kernel, as a share of the gate

PointToLine::Params params_for(const LineScan& moving, const Pose2& T, const LineGate& gate) {
  const SinCos<double> turn = sin_cos(T.theta_rad);
  const std::size_t every = std::max<std::size_t>(1, moving.size() / gate.points);
  return {.x = static_cast<float>(T.x_m),
          .y = static_cast<float>(T.y_m),
          .sin = static_cast<float>(turn.sin),
          .cos = static_cast<float>(turn.cos),
          .gate_m = static_cast<float>(gate.most_m),
          .kernel_m = static_cast<float>(kKernelShare * gate.most_m),
          .least_cosine = static_cast<float>(kSameFace),
          .every = static_cast<std::uint32_t>(every),
          .point_count = static_cast<std::uint32_t>((moving.size() + every - 1) / every)};
}

}  // namespace

// Directions up to half a beam beyond the first and the last are in view.
LineScan::LineScan(std::span<const SurfacePoint> surface) : size_(surface.size()) {
  const std::size_t count = std::max<std::size_t>(size_, PointToLine::kCandidates);
  values_.resize(4 * count);
  float* const x = values_.data();
  for (std::size_t i = 0; i < size_; ++i) {
    x[i] = surface[i].x_m;
    x[count + i] = surface[i].y_m;
    x[2 * count + i] = surface[i].normal_x;
    x[3 * count + i] = surface[i].normal_y;
  }
  std::fill(x + size_, x + count, kFarAway_m);
  constexpr std::size_t kMost = std::numeric_limits<std::uint16_t>::max();
  std::size_t at = 0;
  for (std::size_t bin = 0; bin < first_.size(); ++bin) {
    const float begin = 4.0F * static_cast<float>(bin) / static_cast<float>(PointToLine::kBins) - 2.0F;
    while (at < size_ && surface[at].direction < begin) ++at;
    first_[bin] = static_cast<std::uint16_t>(std::min(at, kMost));
  }
  if (size_ < 2) return;
  low_ = surface[0].direction - 0.5F * (surface[1].direction - surface[0].direction);
  high_ = surface[size_ - 1].direction + 0.5F * (surface[size_ - 1].direction - surface[size_ - 2].direction);
}

PointToLine::Surface LineScan::points() const {
  const std::size_t count = values_.size() / 4;
  const float* const x = values_.data();
  return {x, x + count, x + 2 * count, x + 3 * count, static_cast<std::int32_t>(count)};
}

void find_lines(const LineScan& fixed, const LineScan& moving, const Pose2& T_fixed_moving, const LineGate& gate,
                std::vector<std::int32_t>& found) {
  const PointToLine::Params params = params_for(moving, T_fixed_moving, gate);
  found.resize(params.point_count);
  find_lines_host(best_isa(), params, fixed.lines(), moving.points(), found.data());
}

LineEquations line_equations(const LineScan& fixed, const LineScan& moving, const Pose2& T_fixed_moving,
                             const LineGate& gate, const std::vector<std::int32_t>& found) {
  const PointToLine::Params params = params_for(moving, T_fixed_moving, gate);
  const auto [xx, xy, xt, yy, yt, tt, x, y, t, weight, cost_m2] =
      line_slope_host(best_isa(), params, fixed.lines(), moving.points(), found.data());
  return {.information = {{xx, xy, xt, xy, yy, yt, xt, yt, tt}},
          .gradient = {x, y, t},
          .weight = weight,
          .cost_m2 = cost_m2};
}

LineEquations line_equations(const LineScan& fixed, const LineScan& moving, const Pose2& T_fixed_moving,
                             const LineGate& gate) {
  std::vector<std::int32_t> found;
  find_lines(fixed, moving, T_fixed_moving, gate, found);
  return line_equations(fixed, moving, T_fixed_moving, gate, found);
}

}  // namespace gdtslam
