#include "picture_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace gdtslam {
namespace {

/// Up to this share a neighbour's rise is a plane's tilt if the opposite neighbour falls at least as much; the limit is
/// a plane so flat that its depth doubles within twenty pixels. Above it, only a fall equal to the rise indicates a
/// plane.
constexpr float kTilt = 0.05F;
/// Larger steps of depth darken no more, so that far and near edges look alike.
constexpr float kLargestStep = 0.04F;
/// Rings of neighbours, each twice as wide as the one before.
constexpr std::uint32_t kShadingRings = 3;

/// Nearness of every pixel, 1/distance up to a factor, 0 if nothing was drawn; with an empty rim as wide as the widest
/// ring.
class Nearness {
 public:
  Nearness(const RawPicture& picture, const DepthRange& range, std::uint32_t rim)
      : stride_(std::ptrdiff_t{picture.width} + 2 * std::ptrdiff_t{rim}),
        rim_(rim),
        values_(static_cast<std::size_t>(stride_) * (picture.height + 2 * std::size_t{rim})) {
    // The depth buffer of a perspective camera is linear in 1/distance, that of a parallel one in the distance. Both
    // are linear over the picture of a plane.
    const double span = range.farthest_m - range.nearest_m;
    const auto factor = static_cast<float>(span / (range.is_parallel ? range.equivalent_m : range.farthest_m));
    const auto least = range.is_parallel ? 1.0F : static_cast<float>(range.nearest_m / range.farthest_m);
    const float* depth = picture.depth.data();
    for (std::uint32_t y = 0; y < picture.height; ++y, depth += picture.width) {
      float* row = values_.data() + (y + rim_) * stride_ + rim_;
      for (std::uint32_t x = 0; x < picture.width; ++x) {
        row[x] = depth[x] < 1.0F ? least + (1.0F - depth[x]) * factor : 0.0F;
      }
    }
  }
  [[nodiscard]] const float* row(std::uint32_t y) const { return values_.data() + (y + rim_) * stride_ + rim_; }
  [[nodiscard]] std::ptrdiff_t stride() const { return stride_; }

 private:
  std::ptrdiff_t stride_;
  std::ptrdiff_t rim_;
  std::vector<float> values_;
};

/// Multiplies the row's shades by 1 + the relative rise of two opposite neighbours towards the viewer, without the part
/// that a plane's tilt explains. `scale` converts steps to shares.
[[gnu::noinline]] void add_steps(const float* centre, const float* one, const float* other, const float* scale,
                                 float tilt, std::size_t width, float* __restrict shade) {
  // For vectorisation by four: no arithmetic in the conditionals, no traps (viewer/CMakeLists.txt), and a function of
  // its own, so that GCC trusts __restrict.
  for (std::size_t x = 0; x < width; ++x) {
    const float to_a = one[x] - centre[x];
    const float to_b = other[x] - centre[x];
    const float slightest = tilt * centre[x];
    const float a = one[x] > 0.0F ? to_a : 0.0F;
    const float b = other[x] > 0.0F ? to_b : 0.0F;
    const float rise_a = a > 0.0F ? a : 0.0F;
    const float rise_b = b > 0.0F ? b : 0.0F;
    const float rise = rise_a + rise_b;
    const float fall = rise - (a + b);
    const float less = rise < fall ? rise : fall;
    const float more = rise < fall ? fall : rise;
    const float slight = less < slightest ? less : slightest;
    const float even = less - (more - less);
    const float explained = slight > even ? slight : even;
    const float step = (rise - explained) * scale[x];
    shade[x] *= 1.0F + (step < kLargestStep ? step : kLargestStep);
  }
}

}  // namespace

std::uint32_t shading_reach(std::uint32_t radius) { return radius << (kShadingRings - 1U); }

void shade_eye_dome(RawPicture& picture, const DepthRange& range, std::uint32_t radius) {
  const Nearness nearness(picture, range, shading_reach(radius));
  picture.depth = {};
  std::vector<float> inverse(picture.width);
  std::vector<float> shade;
  shade.reserve(picture.width);
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    // Pixels outside the drawn part of the row are unchanged.
    const float* row = nearness.row(y);
    std::size_t first = 0;
    std::size_t end = picture.width;
    while (first < end && !(row[first] > 0.0F)) ++first;
    while (first < end && !(row[end - 1] > 0.0F)) --end;
    const std::size_t drawn = end - first;
    row += first;
    shade.assign(drawn, 1.0F);
    std::uint8_t* pixel = picture.rgba.data() + 4 * (std::size_t{y} * picture.width + first);
    for (std::size_t x = 0; x < drawn; ++x) {
      inverse[x] = row[x] <= 0.0F ? 0.0F : range.is_parallel ? 1.0F : 1.0F / row[x];
    }
    for (std::uint32_t ring = 0; ring < kShadingRings; ++ring) {
      const std::ptrdiff_t across = std::ptrdiff_t{radius} << ring;
      const std::ptrdiff_t down = across * nearness.stride();
      const float tilt = kTilt * static_cast<float>(across);
      for (const std::ptrdiff_t to_one : {across, down, down + across, down - across}) {
        add_steps(row, row + to_one, row - to_one, inverse.data(), tilt, drawn, shade.data());
      }
    }
    for (const float s : shade) {
      const float light = 1.0F / ((s * s) * (s * s));
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(static_cast<float>(pixel[c]) * light + 0.5F);
      pixel += 4;
    }
  }
}

void set_alpha_from(RawPicture& over_black, const RawPicture& over_white) {
  for (std::size_t i = 0; i < over_black.rgba.size(); i += 4) {
    int difference = 0;
    for (std::size_t c = i; c < i + 3; ++c) difference += over_white.rgba[c] - over_black.rgba[c];
    over_black.rgba[i + 3] = static_cast<std::uint8_t>(255 - std::clamp((difference + 1) / 3, 0, 255));
  }
}

void average_rows(const RawPicture& picture, const AveragedRows& rows, std::uint32_t samples, bool is_premultiplied,
                  RgbaImage& image) {
  const std::uint32_t count = samples * samples;
  for (std::uint32_t done = 0; done < rows.count; ++done) {
    const std::uint32_t y = image.height - 1 - (rows.image_row + done);
    for (std::uint32_t x = 0; x < image.width; ++x) {
      std::array<std::uint32_t, 4> sum{};
      for (std::uint32_t j = 0; j < samples; ++j) {
        const std::size_t row = rows.first + std::size_t{done} * samples + j;
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
}

}  // namespace gdtslam
