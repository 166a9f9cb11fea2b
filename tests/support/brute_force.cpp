#include "brute_force.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/core/elementary.hpp"

namespace gdtslam::test {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFU;

std::size_t index_of(const GridShape& shape, std::int64_t x, std::int64_t y) {
  return static_cast<std::size_t>(y * shape.stride + x);
}

/// A seed's position (row, column): pairs compare in row-major order.
using Position = std::pair<std::int64_t, std::int64_t>;
using Flood = std::vector<std::optional<Position>>;

std::int64_t sq_between(const Position& seed, std::int64_t x, std::int64_t y) {
  return (seed.first - y) * (seed.first - y) + (seed.second - x) * (seed.second - x);
}

Flood flood_pass(const Flood& before, const GridShape& shape, std::int64_t step) {
  Flood after(before.size());
  for (std::int64_t y = 0; y < shape.height; ++y) {
    for (std::int64_t x = 0; x < shape.width; ++x) {
      std::vector<std::pair<std::int64_t, Position>> found;
      for (const std::int64_t ny : {y + step, y, y - step}) {
        for (const std::int64_t nx : {x + step, x, x - step}) {
          const bool inside = ny >= 0 && nx >= 0 && ny < shape.height && nx < shape.width;
          if (inside && before[index_of(shape, nx, ny)]) {
            const Position seed = *before[index_of(shape, nx, ny)];
            found.emplace_back(sq_between(seed, x, y), seed);
          }
        }
      }
      if (!found.empty()) {
        after[index_of(shape, x, y)] = std::min_element(found.begin(), found.end())->second;
      }
    }
  }
  return after;
}

/// One coordinate of a point in the map, in float32, each operation rounded by itself.
float mapped(float a, float x, float b, float y, float t) {
  volatile float ax = a * x;
  volatile float by = b * y;
  volatile float rotated = ax + by;
  volatile float moved = rotated + t;
  return moved;
}

/// Quantised to 1/256 cell with the clamp of the header.
std::int64_t quantised(float cells) {
  volatile float scaled = cells * 256.0F;
  volatile float shifted = scaled + 0.5F;
  const double position = std::floor(static_cast<double>(shifted));
  if (!(position > -1073741824.0)) {
    return -1073741824;
  }
  return position < 1073741824.0 ? static_cast<std::int64_t>(position) : 1073741824;
}

/// floor(q / 256) without a shift.
std::int64_t cell_of(std::int64_t q) { return q >= 0 ? q / 256 : -((255 - q) / 256); }

std::int64_t field_value(const PoseCost::Params& params, const std::vector<std::uint16_t>& field, std::int64_t qx,
                         std::int64_t qy) {
  const auto value = [&](std::int64_t x, std::int64_t y) -> std::int64_t {
    const std::int64_t place = x / 64 * params.strip + x % 64 + y * params.stride;
    return field[static_cast<std::size_t>(place)] ^ params.blank;
  };
  const bool bilinear = params.interpolation == Interpolation::kBilinear;
  const std::int64_t half = bilinear ? 128 : 0;
  const std::int64_t x = std::clamp<std::int64_t>(cell_of(qx - half) + params.anchor_x, 0, params.width - 2);
  const std::int64_t y = std::clamp<std::int64_t>(cell_of(qy - half) + params.anchor_y, 0, params.height - 2);
  if (!bilinear) {
    return value(x, y);
  }
  const std::int64_t fx = qx - half - 256 * cell_of(qx - half);
  const std::int64_t fy = qy - half - 256 * cell_of(qy - half);
  const std::int64_t weighted = value(x, y) * (256 - fx) * (256 - fy) + value(x + 1, y) * fx * (256 - fy) +
                                value(x, y + 1) * (256 - fx) * fy + value(x + 1, y + 1) * fx * fy;
  return weighted / 65536;
}

}  // namespace

std::uint32_t brute_sq_distance(const std::vector<std::uint8_t>& seeds, const GridShape& shape, std::uint32_t x,
                                std::uint32_t y) {
  std::int64_t best = kNone;
  for (std::int64_t j = 0; j < shape.height; ++j) {
    for (std::int64_t i = 0; i < shape.width; ++i) {
      if (seeds[index_of(shape, i, j)] != 0) {
        best = std::min(best, (i - x) * (i - x) + (j - y) * (j - y));
      }
    }
  }
  return static_cast<std::uint32_t>(best);
}

std::vector<std::uint32_t> brute_sq_distances(const std::vector<std::uint8_t>& seeds, const GridShape& shape) {
  std::vector<std::uint32_t> result(std::size_t{shape.stride} * shape.height, 0);
  for (std::uint32_t y = 0; y < shape.height; ++y) {
    for (std::uint32_t x = 0; x < shape.width; ++x) {
      result[index_of(shape, x, y)] = brute_sq_distance(seeds, shape, x, y);
    }
  }
  return result;
}

std::uint16_t brute_merge(const GdtMerge::Params& params, std::uint16_t global, std::uint16_t scan) {
  const std::int64_t G = global;
  const std::int64_t D = scan;
  const std::int64_t d = G - D;
  const std::int64_t threshold = params.threshold;
  const std::int64_t lifted = D + params.lift;
  if (D >= params.cap) return global;                                            // the scan has nothing here
  if (G >= params.cap) return scan;                                              // the map has nothing here
  if (std::abs(d) <= threshold) return static_cast<std::uint16_t>((G + D) / 2);  // (9)
  if (params.rule == MergeRule::kWorking) {
    return d < 0 ? global : static_cast<std::uint16_t>(lifted);  // (10), (11) as docs/paper.md has them
  }
  return d > 0 ? global : static_cast<std::uint16_t>(std::min<std::int64_t>(lifted, params.cap));  // as printed
}

std::uint32_t brute_pose_cost(const PoseCost::Params& params, const std::vector<std::uint16_t>& field,
                              const std::vector<PointCells>& points, const PoseCandidate& candidate) {
  const SinCos<float> rotation = sin_cos(candidate.theta);
  int bits = 0;  // of the cap
  while ((std::int64_t{1} << bits) <= std::int64_t{params.cap}) {
    ++bits;
  }
  const std::int64_t divisor = std::int64_t{1} << std::max(0, 2 * bits - 16);
  std::int64_t sum = candidate.bias;
  for (const PointCells& point : points) {
    const float u = mapped(rotation.cos, point.x, -rotation.sin, point.y, candidate.x);
    const float v = mapped(rotation.sin, point.x, rotation.cos, point.y, candidate.y);
    const std::int64_t value =
        std::min<std::int64_t>(field_value(params, field, quantised(u), quantised(v)), params.cap);
    sum += params.form == CostForm::kSquared ? value * value / divisor : value;
  }
  return static_cast<std::uint32_t>(std::min<std::int64_t>(sum, kNone));
}

std::vector<std::uint16_t> brute_point_values(const PointValues::Params& params,
                                              const std::vector<std::uint16_t>& field,
                                              const std::vector<PointCells>& points, const PointValues::Pose& pose) {
  const SinCos<float> rotation = sin_cos(pose.theta);
  const auto cell = [](float coordinate, std::int32_t anchor, std::uint32_t size) {
    volatile float wanted = std::floor(coordinate) + static_cast<float>(anchor);
    const float in_grid = wanted;
    return static_cast<std::size_t>(std::clamp(in_grid, 0.0F, static_cast<float>(size - 1)));
  };
  std::vector<std::uint16_t> values;
  for (const PointCells& point : points) {
    const float u = mapped(rotation.cos, point.x, -rotation.sin, point.y, pose.x);
    const float v = mapped(rotation.sin, point.x, rotation.cos, point.y, pose.y);
    const std::size_t x = cell(u, params.anchor_x, params.width);
    const std::size_t y = cell(v, params.anchor_y, params.height);
    const std::uint32_t found = field[x / 64 * params.strip + x % 64 + y * params.stride];
    values.push_back(static_cast<std::uint16_t>(found ^ params.blank));
  }
  return values;
}

std::vector<std::uint16_t> truncated(const std::vector<std::uint32_t>& sq_distances, std::uint32_t radius) {
  std::vector<std::uint16_t> result(sq_distances.size());
  std::transform(sq_distances.begin(), sq_distances.end(), result.begin(),
                 [radius](std::uint32_t sq) { return static_cast<std::uint16_t>(std::min(sq, radius * radius)); });
  return result;
}

std::vector<std::uint32_t> brute_jump_flood(const std::vector<std::uint32_t>& steps,
                                            const std::vector<std::uint8_t>& seeds, const GridShape& shape) {
  Flood flood(seeds.size());
  for (std::int64_t y = 0; y < shape.height; ++y) {
    for (std::int64_t x = 0; x < shape.width; ++x) {
      if (seeds[index_of(shape, x, y)] != 0) {
        flood[index_of(shape, x, y)] = Position{y, x};
      }
    }
  }
  for (const std::uint32_t step : steps) {
    flood = flood_pass(flood, shape, step);
  }
  std::vector<std::uint32_t> result(seeds.size(), kNone);
  for (std::int64_t y = 0; y < shape.height; ++y) {
    for (std::int64_t x = 0; x < shape.width; ++x) {
      if (const auto& seed = flood[index_of(shape, x, y)]) {
        result[index_of(shape, x, y)] = static_cast<std::uint32_t>(sq_between(*seed, x, y));
      }
    }
  }
  return result;
}

}  // namespace gdtslam::test
