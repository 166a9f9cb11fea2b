#include "loops_picture.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "cell_image.hpp"
#include "gdtslam/drawing/ticks.hpp"
#include "graph_layer.hpp"
#include "map_sheet.hpp"

namespace gdtslam {
namespace {

using namespace picture;

constexpr MapColours kLoopsMap{colour_for(0x59616c), ink::kCard, colour_for(0xebe9e3)};
constexpr Colour kGlow = colour_for(0xff8a1f);
constexpr Colour kRobot = colour_for(0xd9480f);
constexpr double kWallPx = 1.6;      // times `unit`: the side of what is drawn of a wall
constexpr double kWallShade = 0.55;  // of one sight of it; more make it darker
constexpr double kRobotPx = 7.0;
constexpr double kGlowPx = 13.0;

/// Squares around points, shade upon shade.
class WallImage {
 public:
  explicit WallImage(const Panel& panel)
      : image_(std::make_shared<RgbaImage>(static_cast<std::uint32_t>(panel.width_px),
                                           static_cast<std::uint32_t>(panel.height_px))) {}

  void add(const Point2& at, double side_px, double shade) {
    const double half = 0.5 * side_px;
    if (!is_on_sheet(at)) return;
    const auto [left, right] = pixels_between(at.x() - half, at.x() + half, image_->width);
    const auto [top, bottom] = pixels_between(at.y() - half, at.y() + half, image_->height);
    for (std::uint32_t y = top; y < bottom; ++y) {
      for (std::uint32_t x = left; x < right; ++x) darken(image_->at(x, y), shade);
    }
  }
  [[nodiscard]] std::shared_ptr<const RgbaImage> image() const { return image_; }

 private:
  /// The pixels whose middle lies between; at least the one around the middle, where the sheet has it.
  static std::pair<std::uint32_t, std::uint32_t> pixels_between(double from, double to, std::uint32_t count) {
    double begin = std::ceil(from - 0.5);
    double end = std::ceil(to - 0.5);
    if (end <= begin) end = (begin = std::floor(0.5 * (from + to))) + 1.0;
    const auto held = [count](double pixel) {
      return static_cast<std::uint32_t>(std::clamp(pixel, 0.0, static_cast<double>(count)));
    };
    return {held(begin), held(end)};
  }
  static void darken(std::uint8_t* pixel, double shade) {
    pixel[0] = kLoopsMap.wall.red;
    pixel[1] = kLoopsMap.wall.green;
    pixel[2] = kLoopsMap.wall.blue;
    pixel[3] = static_cast<std::uint8_t>(std::lround(pixel[3] + shade * (255.0 - pixel[3])));
  }

  std::shared_ptr<RgbaImage> image_;
};

void draw_walls(Canvas& canvas, const MapFrame& frame, const LoopsScene& scene, const LoopsMoment& moment,
                double unit) {
  const double share = std::clamp(moment.map_share, 0.0, 1.0);
  if (share > 0.0) {
    PlacedImage placed = occupancy_image(*scene.map, frame, kLoopsMap);
    if (placed.image != nullptr && share < 1.0) {
      auto faded = std::make_shared<RgbaImage>(*placed.image);
      for (std::size_t k = 3; k < faded->pixels.size(); k += 4) {
        faded->pixels[k] = static_cast<std::uint8_t>(std::lround(share * faded->pixels[k]));
      }
      placed.image = std::move(faded);
    }
    draw(canvas, placed);
  }
  if (share >= 1.0 || moment.walls_m.empty()) return;
  WallImage image(frame.panel);
  const double side = std::max(kWallPx * unit, scene.map->geometry.resolution_m * frame.px_per_m);
  for (const Point2& wall : moment.walls_m) image.add(frame.pixel_of(wall), side, (1.0 - share) * kWallShade);
  draw(canvas, {frame.panel, image.image()});
}

void draw_moved_loops(Canvas& canvas, const MapFrame& frame, const LoopsMoment& moment, const Proportions& sizes) {
  for (const MovedLoop& loop : moment.loops) {
    const Point2 from = frame.pixel_of(loop.from_m);
    const Point2 to = frame.pixel_of(loop.to_m);
    if (loop.glow <= 0.0 || !is_on_sheet(from) || !is_on_sheet(to)) continue;
    const double width = kGlowPx * sizes.unit;
    canvas.line(from, to, {.colour = kGlow, .width = width, .opacity = 0.55 * loop.glow});
    for (const Point2& end : {from, to}) canvas.circle(end, width, Fill{kGlow, 0.45 * loop.glow});
  }
  for (const MovedLoop& loop : moment.loops) {
    draw_loop(canvas, frame.pixel_of(loop.from_m), frame.pixel_of(loop.to_m), loop.weight, loop.is_on, sizes);
  }
}

void draw_driven_path(Canvas& canvas, const MapFrame& frame, const LoopsMoment& moment, double unit) {
  std::vector<Point2> pixels;
  for (const Point2& at_m : moment.path_m) {
    const Point2 at = frame.pixel_of(at_m);
    if (is_on_sheet(at) && (pixels.empty() || (at - pixels.back()).norm() >= 0.8 * unit)) pixels.push_back(at);
  }
  if (pixels.size() > 1) canvas.polyline(std::move(pixels), {.colour = kPathInk, .width = kPathPx * unit});
}

void draw_robot(Canvas& canvas, const MapFrame& frame, const LoopsScene& scene, const LoopsMoment& moment,
                const Proportions& sizes) {
  if (!moment.robot_m) return;
  const Point2 at = frame.pixel_of(*moment.robot_m);
  if (!is_on_sheet(at)) return;
  if (scene.largest_sigma_m > 0.0) {
    const double factor = ellipse_factor(scene.largest_sigma_m, frame.px_per_m, sizes);
    draw_ellipse(canvas, at, moment.robot_covariance, factor * frame.px_per_m, sizes);
  }
  canvas.circle(at, kRobotPx * sizes.unit, Fill{kRobot}, Pen{.colour = ink::kCard, .width = 2.0 * sizes.unit});
}

LegendItems loops_legend(const LoopsScene& scene, double px_per_m, const LegendLook& legend) {
  LegendItems items{swatch_item("wall", kLoopsMap.wall, legend)};
  if (scene.has_loops_on) items.push_back(loops_on_item("loop", legend));
  if (scene.has_loops_off) items.push_back(loops_off_item("loop switched off", legend));
  if (scene.largest_sigma_m > 0.0) {
    items.push_back(ellipse_item("", ellipse_factor(scene.largest_sigma_m, px_per_m, legend.sizes), legend));
  }
  return items;
}

}  // namespace

Canvas loops_picture(const LoopsScene& scene, const LoopsMoment& moment, const MapLook& look, const PictureSize& size) {
  Theme theme = kLightTheme;
  theme.page = kLoopsMap.unknown;
  const auto draw_moment = [&](Canvas& canvas, const MapFrame& frame, const Proportions& sizes) {
    draw_walls(canvas, frame, scene, moment, sizes.unit);
    draw_driven_path(canvas, frame, moment, sizes.unit);
    draw_moved_loops(canvas, frame, moment, sizes);
    draw_robot(canvas, frame, scene, moment, sizes);
  };
  const auto explain = [&](const LegendLook& legend, double px_per_m) { return loops_legend(scene, px_per_m, legend); };
  return drawn({"Loops", shown_area(*scene.map, scene.extent), theme, {{draw_moment, explain}}}, look, size);
}

}  // namespace gdtslam
