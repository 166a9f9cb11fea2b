#include "overview.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "canvas.hpp"
#include "overview_map.hpp"
#include "stroke_font.hpp"

namespace gdtslam {
namespace {

constexpr double kMarginPx = 28.0;
constexpr double kHeaderPx = 64.0;
constexpr double kFooterPx = 62.0;
constexpr double kMinWidthPx = 1200.0;  // what the legend needs
constexpr double kLineRadiusPx = 1.25;
constexpr double kHaloPx = 1.4;

constexpr PixelColour kWhite{255, 255, 255};
constexpr PixelColour kInk{31, 41, 51};
constexpr PixelColour kFaintInk{97, 110, 124};
constexpr PixelColour kFrameLine{154, 165, 177};
constexpr PixelColour kDoubtful{214, 26, 60};
constexpr std::array<PixelColour, 4> kTimeColours = {{{24, 100, 214}, {134, 60, 210}, {214, 51, 132}, {240, 120, 20}}};

/// The colour of a share of the run, 0 at its start and 1 at its end.
PixelColour time_colour(double share) {
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(kTimeColours.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(position), kTimeColours.size() - 2);
  return mix(kTimeColours[i], kTimeColours[i + 1], position - static_cast<double>(i));
}

double share_of(std::size_t index, std::size_t count) {
  return count > 1 ? static_cast<double>(index) / static_cast<double>(count - 1) : 0.0;
}

Pixel2 pixel_of(const OverviewFrame& frame, const StampedPose& pose) {
  return {frame.left_px + (pose.T_map_base.x_m - frame.x_m) / frame.m_per_pixel,
          frame.top_px + (frame.y_m - pose.T_map_base.y_m) / frame.m_per_pixel};
}

/// A layer that draws on the map only.
Layer map_layer(const RgbImage& image, const OverviewFrame& frame) {
  Layer layer(image.width, image.height);
  layer.clip({frame.left_px, frame.top_px}, {frame.left_px + frame.width_px, frame.top_px + frame.height_px});
  return layer;
}

/// The same dots and lines once in white and wider, so that the line stands out from walls.
void draw_path(RgbImage& image, const OverviewFrame& frame, const Trajectory& trajectory) {
  Layer halo = map_layer(image, frame);
  Layer line = map_layer(image, frame);
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Pixel2 a = pixel_of(frame, trajectory[i > 0 ? i - 1 : 0]);
    const Pixel2 b = pixel_of(frame, trajectory[i]);
    halo.stroke(a, b, kLineRadiusPx + kHaloPx, kWhite);
    line.stroke(a, b, kLineRadiusPx, time_colour(share_of(i, trajectory.size())));
  }
  constexpr double kHaloOpacity = 0.75;
  halo.blend_onto(image, kHaloOpacity);
  line.blend_onto(image);
}

/// A disc, ringed in white so that it stands out; white inside when hollow.
void draw_disc_mark(RgbImage& image, const OverviewFrame& frame, Pixel2 centre, PixelColour colour, bool is_hollow) {
  constexpr double kRadiusPx = 8.0;
  Layer ring = map_layer(image, frame);
  ring.disc(centre, kRadiusPx + 2.0, kWhite);
  ring.blend_onto(image);
  Layer disc = map_layer(image, frame);
  disc.disc(centre, kRadiusPx, colour);
  disc.blend_onto(image);
  if (is_hollow) {
    Layer inside = map_layer(image, frame);
    inside.disc(centre, kRadiusPx * 0.5, kWhite);
    inside.blend_onto(image);
  }
}

void add_cross(Layer& layer, Pixel2 p, double arm, double radius, PixelColour colour) {
  layer.stroke({p.x - arm, p.y - arm}, {p.x + arm, p.y + arm}, radius, colour);
  layer.stroke({p.x - arm, p.y + arm}, {p.x + arm, p.y - arm}, radius, colour);
}

void draw_crosses(RgbImage& image, const OverviewFrame& frame, const std::vector<Pixel2>& centres) {
  constexpr double kArmPx = 5.0;
  Layer halo = map_layer(image, frame);
  Layer cross = map_layer(image, frame);
  for (const Pixel2& centre : centres) {
    add_cross(halo, centre, kArmPx, 3.2, kWhite);
    add_cross(cross, centre, kArmPx, 1.5, kDoubtful);
  }
  halo.blend_onto(image, 0.9);
  cross.blend_onto(image);
}

/// A bead on the path, a little wider and darker than it: a white one would cut so thin a line into dashes.
void add_keyframe(Layer& layer, Pixel2 centre, PixelColour path_colour) {
  constexpr double kRadiusPx = 1.9;
  constexpr double kInkShare = 0.3;
  layer.disc(centre, kRadiusPx, mix(path_colour, kInk, kInkShare));
}

void draw_marks(RgbImage& image, const OverviewFrame& frame, const OverviewInput& input) {
  const Trajectory& trajectory = input.trajectory;
  Layer keyframes = map_layer(image, frame);
  for (const std::size_t index : input.keyframes) {
    add_keyframe(keyframes, pixel_of(frame, trajectory.at(index)), time_colour(share_of(index, trajectory.size())));
  }
  keyframes.blend_onto(image);
  std::vector<Pixel2> doubtful;
  for (const std::size_t index : input.doubtful) {
    doubtful.push_back(pixel_of(frame, trajectory.at(index)));
  }
  draw_crosses(image, frame, doubtful);
  if (!trajectory.empty()) {
    draw_disc_mark(image, frame, pixel_of(frame, trajectory.front()), time_colour(0.0), false);
    draw_disc_mark(image, frame, pixel_of(frame, trajectory.back()), time_colour(1.0), true);
  }
}

void draw_frame(RgbImage& image, const OverviewFrame& frame) {
  const Pixel2 min{frame.left_px, frame.top_px};
  const Pixel2 max{frame.left_px + frame.width_px, frame.top_px + frame.height_px};
  Layer border(image.width, image.height);
  border.rectangle({min.x - 1, min.y - 1}, {max.x + 1, min.y}, kFrameLine);
  border.rectangle({min.x - 1, max.y}, {max.x + 1, max.y + 1}, kFrameLine);
  border.rectangle({min.x - 1, min.y}, {min.x, max.y}, kFrameLine);
  border.rectangle({max.x, min.y}, {max.x + 1, max.y}, kFrameLine);
  border.blend_onto(image);
}

/// The longest of 1, 2, 5 times a power of ten that fits; at least a centimetre.
double scale_bar_length_m(double longest_m) {
  double best_m = 0.01;
  for (double decade_m = 0.01; decade_m <= longest_m && decade_m < 1e6; decade_m *= 10.0) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      best_m = factor * decade_m <= longest_m ? factor * decade_m : best_m;
    }
  }
  return best_m;
}

double draw_scale_bar(Layer& layer, const OverviewFrame& frame, Pixel2 left, const TextStyle& style) {
  constexpr double kLongestPx = 220.0;
  const double length_m = scale_bar_length_m(kLongestPx * frame.m_per_pixel);
  const double length_px = length_m / frame.m_per_pixel;
  layer.rectangle({left.x, left.y - 2}, {left.x + length_px, left.y + 2}, kInk);
  for (const double x : {left.x, left.x + length_px - 3.0}) {
    layer.rectangle({x, left.y - 8}, {x + 3.0, left.y + 8}, kInk);
  }
  const std::string label =
      length_m < 1.0 ? fmt::format("{:.0f} cm", 100.0 * length_m) : fmt::format("{:.0f} m", length_m);
  return draw_text(layer, {left.x + length_px + 12.0, left.y + 0.5 * style.cap_height_px}, label, style);
}

double draw_time_legend(Layer& layer, Pixel2 left, const TextStyle& style) {
  constexpr int kSteps = 140;
  const double baseline = left.y + 0.5 * style.cap_height_px;
  double x = draw_text(layer, {left.x, baseline}, "start", style) + 16.0;
  for (int i = 0; i < kSteps; ++i) {
    const double share = static_cast<double>(i) / (kSteps - 1);
    layer.stroke({x + i, left.y}, {x + i + 1, left.y}, 2.5, time_colour(share));
  }
  layer.disc({x, left.y}, 7.0, time_colour(0.0));
  layer.disc({x + kSteps, left.y}, 7.0, time_colour(1.0));
  layer.disc({x + kSteps, left.y}, 3.5, kWhite);
  return draw_text(layer, {x + kSteps + 16.0, baseline}, "end", style);
}

double draw_keyframe_legend(Layer& path, Layer& dots, Pixel2 left, std::size_t count, const TextStyle& style) {
  constexpr double kPathPx = 36.0;  // a piece of the path with its dots, as on the map
  constexpr int kDots = 3;
  const PixelColour colour = time_colour(0.0);
  path.stroke(left, {left.x + kPathPx, left.y}, kLineRadiusPx, colour);
  for (int i = 0; i < kDots; ++i) {
    add_keyframe(dots, {left.x + kPathPx * (i + 0.5) / kDots, left.y}, colour);
  }
  return draw_text(path, {left.x + kPathPx + 12.0, left.y + 0.5 * style.cap_height_px},
                   fmt::format("{} keyframe{}", count, count == 1 ? "" : "s"), style);
}

double draw_doubtful_legend(Layer& layer, Pixel2 left, std::size_t count, const TextStyle& style) {
  add_cross(layer, {left.x + 5.0, left.y}, 5.0, 1.5, kDoubtful);
  return draw_text(layer, {left.x + 22.0, left.y + 0.5 * style.cap_height_px},
                   fmt::format("{} doubtful scan{}", count, count == 1 ? "" : "s"), style);
}

void draw_texts(RgbImage& image, const OverviewFrame& frame, const OverviewInput& input) {
  Layer layer(image.width, image.height);
  const TextStyle title{20.0, kInk};
  const TextStyle small{13.0, kFaintInk};
  const TextStyle legend{14.0, kInk};
  const double title_end = draw_text(layer, {kMarginPx, 46.0}, input.title, title);
  draw_text(layer, {title_end + (input.title.empty() ? 0.0 : 24.0), 46.0}, input.caption, small);
  const double y = static_cast<double>(image.height) - 0.5 * kFooterPx;
  constexpr double kGapPx = 52.0;
  Layer dots(image.width, image.height);
  double x = draw_scale_bar(layer, frame, {kMarginPx, y}, legend) + kGapPx;
  if (!input.trajectory.empty()) {
    x = draw_time_legend(layer, {x, y}, legend) + kGapPx;
  }
  if (!input.keyframes.empty()) {
    x = draw_keyframe_legend(layer, dots, {x, y}, input.keyframes.size(), legend) + kGapPx;
  }
  if (!input.doubtful.empty()) {
    draw_doubtful_legend(layer, {x, y}, input.doubtful.size(), legend);
  }
  layer.blend_onto(image);
  dots.blend_onto(image);
}

}  // namespace

OverviewFrame overview_frame(const OverviewInput& input) {
  const MapArea area = shown_area(input);
  const double width_m = area.max_x_m - area.min_x_m;
  const double height_m = area.max_y_m - area.min_y_m;
  OverviewFrame frame;
  frame.m_per_pixel = std::max(width_m, height_m) / static_cast<double>(kOverviewSide);
  frame.width_px = std::max(1.0, std::floor(width_m / frame.m_per_pixel + 0.5));
  frame.height_px = std::max(1.0, std::floor(height_m / frame.m_per_pixel + 0.5));
  frame.left_px = std::floor(std::max(kMarginPx, 0.5 * (kMinWidthPx - frame.width_px)));
  frame.top_px = kHeaderPx;
  frame.x_m = area.min_x_m;
  frame.y_m = area.max_y_m;
  return frame;
}

RgbImage draw_overview(const OverviewInput& input) {
  const OverviewFrame frame = overview_frame(input);
  RgbImage image;
  image.width = static_cast<std::uint32_t>(frame.width_px + 2.0 * frame.left_px);
  image.height = static_cast<std::uint32_t>(kHeaderPx + frame.height_px + kFooterPx);
  image.pixels.assign(std::size_t{3} * image.width * image.height, 255);
  draw_map(image, frame, input.map);
  draw_path(image, frame, input.trajectory);
  draw_marks(image, frame, input);
  draw_frame(image, frame);
  draw_texts(image, frame, input);
  return image;
}

void write_overview(const std::string& path, const OverviewInput& input) {
  write_png(path, draw_overview(input).view());
}

}  // namespace gdtslam
