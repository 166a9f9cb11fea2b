#include "brute_bounds.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"

namespace gdtslam::test {
namespace {

/// A sum or a product that is rounded to float32 and kept from being fused with another.
float sum_of(float a, float b) {
  volatile float sum = a + b;
  return sum;
}
float product_of(float a, float b) {
  volatile float product = a * b;
  return product;
}

/// The sample that a position lies in, with what pose_bounds.hpp says of far ones and of NaN.
std::int64_t sample_at(const PoseBounds::Params& params, float position) {
  const std::int64_t spacing = std::int64_t{1} << params.phase_bits;
  const float scale = params.samples_per_cell;
  const float bias = sum_of(sum_of(0.5F, -product_of(0.5F, scale)), static_cast<float>(spacing));
  const double place = std::floor(static_cast<double>(sum_of(product_of(position, scale), bias)));
  if (std::isnan(place)) return -1073741824 - spacing;
  return static_cast<std::int64_t>(std::clamp(place, -1073741824.0, 1073741824.0)) - spacing;
}

struct Split {
  std::int64_t whole;
  std::int64_t rest;
};

Split split(std::int64_t value, std::int64_t by) {
  const auto whole = static_cast<std::int64_t>(std::floor(static_cast<double>(value) / static_cast<double>(by)));
  return {whole, value - whole * by};
}

}  // namespace

std::vector<std::uint32_t> brute_bounds(const PoseBounds::Params& params, const std::vector<std::uint8_t>& field,
                                        const std::vector<BoundPoint>& points, const PoseCandidate& tile) {
  const SinCos<float> rotation = sin_cos(tile.theta);
  const std::int64_t spacing = std::int64_t{1} << params.phase_bits;
  const std::int64_t width = params.width;
  const std::int64_t height = params.height;
  std::vector<std::uint32_t> sums(std::size_t{params.tile_width} * params.tile_height, 0);
  for (const BoundPoint& point : points) {
    const float x = sum_of(product_of(rotation.cos, point.x), product_of(-rotation.sin, point.y));
    const float y = sum_of(product_of(rotation.sin, point.x), product_of(rotation.cos, point.y));
    const Split u = split(sample_at(params, sum_of(x, tile.x)), spacing);
    const Split v = split(sample_at(params, sum_of(y, tile.y)), spacing);
    const std::int64_t column = std::clamp<std::int64_t>(u.whole + params.first_column, 0, width - params.tile_width);
    const std::int64_t row = std::clamp<std::int64_t>(v.whole + params.first_row, 0, height - params.tile_height);
    const std::int64_t plane = std::min(point.field, params.last_field) + (v.rest * spacing + u.rest) * width * height;
    for (std::int64_t j = 0; j < params.tile_height; ++j) {
      for (std::int64_t i = 0; i < params.tile_width; ++i) {
        sums[static_cast<std::size_t>(j * params.tile_width + i)] +=
            field.at(static_cast<std::size_t>(plane + (row + j) * width + column + i));
      }
    }
  }
  return sums;
}

}  // namespace gdtslam::test
