#include "canvas.hpp"

#include <algorithm>
#include <cmath>

namespace gdtslam {
namespace {

constexpr double kFull = 255.0;

std::uint8_t mixed(std::uint8_t a, std::uint8_t b, double share) {
  return static_cast<std::uint8_t>(static_cast<double>(a) + share * (static_cast<double>(b) - static_cast<double>(a)) +
                                   0.5);
}

/// The pixels that [low, high] touches, within the clip.
PixelRange touched(double low, double high, double clip_min, double clip_max) {
  const double begin = std::clamp(std::floor(low), clip_min, clip_max);
  const double end = std::clamp(std::ceil(high), clip_min, clip_max);
  return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
}

double distance_to_segment(Pixel2 p, Pixel2 a, Pixel2 b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double sq_length = dx * dx + dy * dy;
  const double along = sq_length > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / sq_length, 0.0, 1.0) : 0.0;
  const double ex = p.x - (a.x + along * dx);
  const double ey = p.y - (a.y + along * dy);
  return std::sqrt(ex * ex + ey * ey);
}

/// Length of the overlap of a pixel with an interval.
double overlap(std::uint32_t pixel, double low, double high) {
  const double begin = static_cast<double>(pixel);
  return std::max(0.0, std::min(begin + 1.0, high) - std::max(begin, low));
}

}  // namespace

PixelColour mix(PixelColour a, PixelColour b, double share) {
  return {mixed(a.r, b.r, share), mixed(a.g, b.g, share), mixed(a.b, b.b, share)};
}

Layer::Layer(std::uint32_t width, std::uint32_t height)
    : width_(width),
      clip_max_{static_cast<double>(width), static_cast<double>(height)},
      coverage_(std::size_t{width} * height),
      colours_(std::size_t{width} * height) {}

void Layer::clip(Pixel2 min, Pixel2 max) {
  clip_min_ = {std::clamp(min.x, 0.0, clip_max_.x), std::clamp(min.y, 0.0, clip_max_.y)};
  clip_max_ = {std::clamp(max.x, clip_min_.x, clip_max_.x), std::clamp(max.y, clip_min_.y, clip_max_.y)};
}

PixelRange Layer::rows(double low, double high) const { return touched(low, high, clip_min_.y, clip_max_.y); }
PixelRange Layer::columns(double low, double high) const { return touched(low, high, clip_min_.x, clip_max_.x); }

void Layer::cover(std::size_t pixel, double coverage, PixelColour colour) {
  const auto level = static_cast<std::uint8_t>(std::clamp(coverage, 0.0, 1.0) * kFull + 0.5);
  if (level > 0 && level >= coverage_[pixel]) {
    coverage_[pixel] = level;
    colours_[pixel] = colour;
  }
}

void Layer::stroke(Pixel2 a, Pixel2 b, double radius, PixelColour colour) {
  if (!std::isfinite(a.x + a.y + b.x + b.y)) {
    return;
  }
  const double reach = radius + 1.0;
  const PixelRange y_range = rows(std::min(a.y, b.y) - reach, std::max(a.y, b.y) + reach);
  const PixelRange x_range = columns(std::min(a.x, b.x) - reach, std::max(a.x, b.x) + reach);
  for (std::uint32_t y = y_range.begin; y < y_range.end; ++y) {
    for (std::uint32_t x = x_range.begin; x < x_range.end; ++x) {
      const Pixel2 centre{static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5};
      cover(std::size_t{y} * width_ + x, radius + 0.5 - distance_to_segment(centre, a, b), colour);
    }
  }
}

void Layer::rectangle(Pixel2 min, Pixel2 max, PixelColour colour) {
  const PixelRange y_range = rows(min.y, max.y);
  const PixelRange x_range = columns(min.x, max.x);
  for (std::uint32_t y = y_range.begin; y < y_range.end; ++y) {
    for (std::uint32_t x = x_range.begin; x < x_range.end; ++x) {
      cover(std::size_t{y} * width_ + x, overlap(x, min.x, max.x) * overlap(y, min.y, max.y), colour);
    }
  }
}

void Layer::blend_onto(RgbImage& image, double opacity) const {
  for (std::size_t pixel = 0; pixel < coverage_.size(); ++pixel) {
    if (coverage_[pixel] == 0) {
      continue;
    }
    const double share = opacity * static_cast<double>(coverage_[pixel]) / kFull;
    std::uint8_t* const p = image.pixels.data() + 3 * pixel;
    const PixelColour result = mix({p[0], p[1], p[2]}, colours_[pixel], share);
    p[0] = result.r;
    p[1] = result.g;
    p[2] = result.b;
  }
}

}  // namespace gdtslam
