#include "graphics/shading.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace gdtslam {
namespace {

/// How far two pixels' nearness may differ by a plane's tilt alone, as a share: a plane seen so flat that its depth
/// doubles within twenty pixels. Steeper steps are edges on both sides.
constexpr float kTilt = 0.05F;
/// Exponent of the darkening, as 2^kDoublings: a step of depth by 2 % on one side darkens by about a quarter.
constexpr int kDoublings = 4;

// Nearness is 1/distance up to a factor; 0 where nothing was drawn.
class Nearness {
 public:
  Nearness(const RawPicture& picture, const DepthRange& range)
      : width_(picture.width), height_(picture.height), values_(picture.depth.size()) {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      values_[i] = picture.depth[i] >= 1.0F ? 0.0F : of_depth(picture.depth[i], range);
    }
  }
  [[nodiscard]] const float* row(std::uint32_t y) const { return values_.data() + std::size_t{y} * width_; }
  [[nodiscard]] std::uint32_t width() const { return width_; }
  [[nodiscard]] std::uint32_t height() const { return height_; }

 private:
  // A parallel camera's depth is linear over planes itself, so nearness is a linear function of it too.
  static float of_depth(float depth, const DepthRange& range) {
    const auto span = static_cast<float>((range.farthest_m - range.nearest_m) /
                                         (range.is_parallel ? range.equivalent_m : range.farthest_m));
    if (range.is_parallel) return 1.0F + (1.0F - depth) * span;
    return static_cast<float>(range.nearest_m / range.farthest_m) + (1.0F - depth) * span;
  }
  std::uint32_t width_;
  std::uint32_t height_;
  std::vector<float> values_;
};

// How much nearer than the pixel the two opposite neighbours are, as shares, without what a plane's tilt explains.
inline float step_over(float centre, float one, float other) {
  const float a = one > 0.0F ? one - centre : 0.0F;
  const float b = other > 0.0F ? other - centre : 0.0F;
  const float rise = std::max(a, 0.0F) + std::max(b, 0.0F);
  const float fall = std::max(-a, 0.0F) + std::max(-b, 0.0F);
  return rise - std::min(std::min(rise, fall), kTilt * centre);
}

// The light that is left, 0 to 1: prod (1 + step)^-2^kDoublings/4 over the four pairs of neighbours.
float light_left(float centre, const std::array<float, 8>& around) {
  float product = 1.0F;
  const float inverse = 1.0F / centre;
  for (std::size_t i = 0; i < 8; i += 2) product *= 1.0F + step_over(centre, around[i], around[i + 1]) * inverse;
  product = std::min(product, 8.0F);
  float light = 1.0F / std::sqrt(std::sqrt(product));
  for (int i = 0; i < kDoublings; ++i) light *= light;
  return light;
}

}  // namespace

void shade_eye_dome(RawPicture& picture, const DepthRange& range, std::uint32_t radius) {
  const Nearness nearness(picture, range);
  const std::uint32_t width = nearness.width();
  const std::uint32_t height = nearness.height();
  for (std::uint32_t y = 0; y < height; ++y) {
    const float* row = nearness.row(y);
    const float* below = nearness.row(y >= radius ? y - radius : 0);
    const float* above = nearness.row(std::min(y + radius, height - 1));
    std::uint8_t* pixel = picture.rgba.data() + std::size_t{4} * width * y;
    for (std::uint32_t x = 0; x < width; ++x, pixel += 4) {
      if (row[x] <= 0.0F) continue;
      const std::uint32_t left = x >= radius ? x - radius : 0;
      const std::uint32_t right = std::min(x + radius, width - 1);
      const float light = light_left(
          row[x], {row[left], row[right], below[x], above[x], below[left], above[right], below[right], above[left]});
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(static_cast<float>(pixel[c]) * light + 0.5F);
    }
  }
}

RgbaImage averaged(const RawPicture& picture, std::uint32_t samples, bool is_premultiplied) {
  RgbaImage image(picture.width / samples, picture.height / samples);
  const std::uint32_t count = samples * samples;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      std::array<std::uint32_t, 4> sum{};
      for (std::uint32_t j = 0; j < samples; ++j) {
        const std::size_t row = std::size_t{image.height - 1 - y} * samples + j;
        const std::uint8_t* from = picture.rgba.data() + 4 * (row * picture.width + std::size_t{x} * samples);
        for (std::size_t k = 0; k < std::size_t{4} * samples; ++k) sum[k % 4] += from[k];
      }
      std::uint8_t* to = image.at(x, y);
      const bool is_partial = is_premultiplied && sum[3] != 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t value = is_partial ? (255 * sum[c] + sum[3] / 2) / sum[3] : (sum[c] + count / 2) / count;
        to[c] = static_cast<std::uint8_t>(std::min(value, std::uint32_t{255}));
      }
      to[3] = static_cast<std::uint8_t>((sum[3] + count / 2) / count);
    }
  }
  return image;
}

}  // namespace gdtslam
