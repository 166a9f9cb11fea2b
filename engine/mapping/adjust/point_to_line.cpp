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
  points_.resize(count, {.x = kFarAway_m, .y = kFarAway_m});
  places_.resize(2 * count, kFarAway_m);
  for (std::size_t i = 0; i < size_; ++i) {
    const SurfacePoint& p = surface[i];
    points_[i] = {places_[i] = p.x_m, places_[count + i] = p.y_m, p.normal_x, p.normal_y};
  }
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

PointToLine::Lines LineScan::lines() const {
  const std::size_t count = points_.size();
  return {points_.data(), places_.data(), places_.data() + count, static_cast<std::int32_t>(count), first_.data(),
          low_,           high_};
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
