#include "brute_ndt.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "single.hpp"

namespace gdtslam::test {
namespace {

using Triple = std::array<Single, 3>;

Single doubled(Single value) { return value + value; }

Triple moved(const NdtCost::Params& params, const NdtCost::Pose& pose, const NdtCost::Point& point) {
  const std::array origin{params.origin_x_m, params.origin_y_m, params.origin_z_m};
  Triple place;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float* const row = pose.rotation + 3 * axis;
    const Single turned =
        Single{row[0]} * Single{point.x} + Single{row[1]} * Single{point.y} + Single{row[2]} * Single{point.z};
    place[axis] = turned + (Single{pose.translation_m[axis]} - Single{origin[axis]});
  }
  return place;
}

/// The number of the cube of a place in the box.
std::optional<std::size_t> cube_of(const NdtCost::Params& params, const Triple& place) {
  const std::array sides{params.size_x, params.size_y, params.size_z};
  std::size_t number = 0;
  for (std::size_t axis = 3; axis-- > 0;) {
    const Single counted = place[axis] * Single{params.cubes_per_m} + Single{1.0F};
    const double cube = std::floor(static_cast<double>(counted.value)) - 1.0;
    if (!(cube >= 0.0 && cube < sides[axis])) return std::nullopt;
    number = number * sides[axis] + static_cast<std::size_t>(cube);
  }
  return number;
}

std::size_t step_of(const NdtCost::Params& params, const std::array<Single, 9>& normal, const Triple& place) {
  const auto& [mean_x, mean_y, mean_z, xx, xy, xz, yy, yz, zz] = normal;
  const Single dx = place[0] - mean_x;
  const Single dy = place[1] - mean_y;
  const Single dz = place[2] - mean_z;
  const Single u = xx * dx + doubled(xy * dy + xz * dz);
  const Single v = yy * dy + doubled(yz * dz);
  const Single steps = ((u * dx + v * dy) + (zz * dz) * dz) * Single{params.steps_per_unit};
  if (!(steps.value < 255.0F)) return 255;
  return steps.value > 0.0F ? static_cast<std::size_t>(steps.value) : 0;
}

}  // namespace

std::uint32_t brute_ndt_score(const NdtCost::Params& params, const std::vector<std::uint32_t>& map,
                              const std::vector<NdtCost::Point>& points, const NdtCost::Pose& pose) {
  std::uint32_t score = 0;
  for (const NdtCost::Point& point : points) {
    const Triple place = moved(params, pose, point);
    const std::optional<std::size_t> cube = cube_of(params, place);
    if (!cube) continue;
    const std::size_t distribution = map[256 + std::size_t{12} * params.distribution_count + *cube];
    if (distribution >= params.distribution_count) continue;
    std::array<Single, 9> normal;
    for (std::size_t i = 0; i < 9; ++i) normal[i] = {std::bit_cast<float>(map[256 + 12 * distribution + i])};
    score += map[step_of(params, normal, place)];
  }
  return score;
}

}  // namespace gdtslam::test
