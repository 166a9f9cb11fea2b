// The graph of a run over its map, and one moment of its loop closing.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "cell_image.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/ticks.hpp"
#include "map_pictures.hpp"
#include "map_sheet.hpp"
#include "path_layer.hpp"

namespace gdtslam {
namespace {

using namespace picture;

/// Pale colours, so that lines over walls are visible.
constexpr MapColours kGraphMap{colour_for(0x868c95), ink::kCard, colour_for(0xebe9e3)};
constexpr Colour kPathInk = colour_for(0x3b4552);
constexpr double kPathPx = 1.7;
constexpr double kEllipsePx = 30.0;     // in `unit`: larger ellipses are not enlarged
constexpr double kEllipseStep = 56.0;   // spacing along the path
constexpr double kEllipseApart = 26.0;  // distance from those of other visits
constexpr double kMostEnlarged = 1.0e4;
constexpr double kSigmas = 3.0;
constexpr int kEllipsePoints = 48;
constexpr double kNodePx = 2.3;
constexpr double kLoopPx = 2.6;
constexpr double kLoopEndPx = 3.4;
constexpr double kBandPx = 15.0;
constexpr double kPiecePx = 46.0;  // length of a line in the legend
constexpr double kPinPx = 13.0;
constexpr double kLeastWeight = 0.25;  // least weight of a loop that holds

constexpr Colour kWeakLoop = colour_for(0x8fc9f2);
constexpr Colour kStrongLoop = colour_for(0x0b4fa8);
constexpr Colour kEllipseInk = colour_for(0x8a3f86);
constexpr Colour kBand = colour_for(0xffb52e);

Colour loop_colour(double weight) {
  return mixed(kWeakLoop, kStrongLoop, std::clamp((weight - kLeastWeight) / (1.0 - kLeastWeight), 0.0, 1.0));
}

/// Points of a covariance's ellipse around its pose, from the covariance's square root.
std::vector<Point2> ellipse_around(const Point2& centre, const PoseCovariance& c, double px_per_sigma) {
  const double across = std::sqrt(std::max(0.0, c.xx));
  const double slant = across > 0.0 ? c.xy / across : 0.0;
  const double along = std::sqrt(std::max(0.0, c.yy - slant * slant));
  std::vector<Point2> points;
  points.reserve(kEllipsePoints + 1);
  for (int k = 0; k <= kEllipsePoints; ++k) {
    const SinCos<double> turn = sin_cos(2.0 * kPi * k / kEllipsePoints);
    const double x = across * turn.cos;
    const double y = slant * turn.cos + along * turn.sin;
    points.push_back(centre + px_per_sigma * Point2(x, -y));
  }
  return points;
}

double ellipse_factor(double sigma_m, double px_per_m, const Proportions& sizes) {
  return std::clamp(round_length_m(kEllipsePx * sizes.unit / (kSigmas * sigma_m * px_per_m)), 1.0, kMostEnlarged);
}

void draw_loop(Canvas& canvas, const Point2& from, const Point2& to, double weight, bool is_on,
               const Proportions& sizes) {
  if (!is_on_sheet(from) || !is_on_sheet(to)) return;
  const Colour colour = is_on ? loop_colour(weight) : ink::kWarning;
  canvas.line(from, to, {.colour = colour, .width = kLoopPx * sizes.unit, .dashes = is_on ? "" : "7 5"});
  for (const Point2& end : {from, to}) canvas.circle(end, kLoopEndPx * sizes.unit, Fill{colour});
}

void draw_ellipse(Canvas& canvas, const Point2& centre, const PoseCovariance& covariance, double px_per_m,
                  const Proportions& sizes) {
  std::vector<Point2> points = ellipse_around(centre, covariance, kSigmas * px_per_m);
  if (!std::all_of(points.begin(), points.end(), is_on_sheet)) return;
  canvas.polygon(points, Fill{kEllipseInk, 0.10});
  canvas.polyline(std::move(points), {.colour = kEllipseInk, .width = 1.3 * sizes.unit, .opacity = 0.9});
}

LegendItem loops_on_item(const std::string& words, const LegendLook& look) {
  const auto colour_at = [](double share) { return loop_colour(kLeastWeight + share * (1.0 - kLeastWeight)); };
  return colour_bar_item(words + ", weight 0.25", "1", colour_at, look);
}

LegendItem loops_off_item(const std::string& words, const LegendLook& look) {
  const double piece = kPiecePx * look.sizes.unit;
  return legend_item(
      "", piece,
      [piece, sizes = look.sizes](Canvas& canvas, const Point2& left) {
        draw_loop(canvas, left, left + Point2(piece, 0.0), 0.0, false, sizes);
      },
      words, look);
}

LegendItem ellipse_item(const std::string& every, double factor, const LegendLook& look) {
  const double radius = 0.3 * kPiecePx * look.sizes.unit;
  return legend_item(
      "", 2.0 * radius,
      [radius, sizes = look.sizes](Canvas& canvas, const Point2& left) {
        draw_ellipse(canvas, left + Point2(radius, 0.0), {.xx = 1.0, .xy = 0.25, .yy = 0.35}, radius / kSigmas, sizes);
      },
      "3 sigma" + every + (factor > 1.0 ? fmt::format(", {:g} times as large", factor) : ""), look);
}

/// Spacing of ellipses in metres of path, and their enlargement.
struct EllipseScale {
  double every_m = 0.0;  ///< 0: no covariances
  double factor = 1.0;
};
EllipseScale ellipse_scale(const GraphOverlay& overlay, double px_per_m, const Proportions& sizes) {
  double sigma_m = 0.0;
  for (const PoseCovariance& covariance : overlay.covariances) sigma_m = std::max(sigma_m, covariance.sigma_m());
  if (!(sigma_m > 0.0) || !std::isfinite(sigma_m)) return {};
  return {round_length_m(2.0 * kEllipseStep * sizes.unit / px_per_m), ellipse_factor(sigma_m, px_per_m, sizes)};
}

/// Draws ellipses at the given spacing; in each place that of the least certain pose.
void draw_ellipses(Canvas& canvas, const MapFrame& frame, const GraphOverlay& overlay, const Proportions& sizes) {
  const EllipseScale scale = ellipse_scale(overlay, frame.px_per_m, sizes);
  if (scale.every_m <= 0.0) return;
  const double apart_px = kEllipseApart * sizes.unit;
  std::map<std::pair<long, long>, std::size_t> taken;
  const auto pixel = [&](std::size_t i) { return frame.to_pixel(overlay.trajectory[i].T_map_base.translation()); };
  double since_m = scale.every_m;
  for (std::size_t i = 0; i < overlay.covariances.size(); ++i) {
    if (i > 0) {
      since_m += between(overlay.trajectory[i - 1].T_map_base, overlay.trajectory[i].T_map_base).translation().norm();
    }
    const Point2 at = pixel(i);
    if (since_m < scale.every_m || !is_on_sheet(at)) continue;
    since_m = 0.0;
    const std::pair key{std::lround(at.x() / apart_px), std::lround(at.y() / apart_px)};
    const auto [place, is_new] = taken.try_emplace(key, i);
    if (!is_new && overlay.covariances[i].sigma_m() > overlay.covariances[place->second].sigma_m()) place->second = i;
  }
  for (const auto& [key, i] : taken) {
    draw_ellipse(canvas, pixel(i), overlay.covariances[i], scale.factor * frame.px_per_m, sizes);
  }
}

void draw_pin(Canvas& canvas, const Point2& at, std::size_t number, const Proportions& sizes) {
  const double radius = kPinPx * sizes.unit;
  const Point2 centre = at + Point2(1.5 * radius, -1.5 * radius);
  canvas.line(at, centre, {.colour = ink::kText, .width = 1.6 * sizes.unit});
  canvas.circle(centre, radius, Fill{ink::kText}, Pen{.colour = ink::kCard, .width = 2.0 * sizes.unit});
  const double letters = 0.95 * sizes.small_px;
  canvas.text(centre + Point2(0.0, 0.36 * letters), std::to_string(number),
              {.size = letters, .colour = ink::kCard, .anchor = Anchor::kMiddle, .is_bold = true});
}

void draw_stretches(Canvas& canvas, const MapFrame& frame, const GraphOverlay& overlay, const Proportions& sizes) {
  for (const PathStretch& stretch : overlay.doubtful) {
    std::vector<Point2> band;
    for (const SeenPose& pose : seen_poses(frame, overlay.trajectory, stretch.from, stretch.to + 1, sizes.unit)) {
      band.push_back(pose.at);
    }
    if (band.size() == 1) canvas.circle(band.front(), 0.5 * kBandPx * sizes.unit, Fill{kBand, 0.8});
    if (band.size() > 1) {
      canvas.polyline(std::move(band), {.colour = kBand, .width = kBandPx * sizes.unit, .opacity = 0.8});
    }
  }
}

void draw_graph(Canvas& canvas, const MapFrame& frame, const GraphOverlay& overlay, const Proportions& sizes) {
  const auto ink = [](auto /*place*/) { return kPathInk; };
  draw_stretches(canvas, frame, overlay, sizes);
  draw_line_of_values(canvas, frame, {overlay.trajectory, overlay.drives, {}}, ink,
                      {std::nullopt, kPathPx * sizes.unit});
  draw_dots(canvas, frame, overlay.trajectory, overlay.keyframes, kNodePx * sizes.unit, ink);
  draw_ellipses(canvas, frame, overlay, sizes);
  for (const bool is_on : {true, false}) {  // loops switched off are few and drawn on top
    for (const LoopLine& loop : overlay.loops) {
      const Point2 from = frame.to_pixel(overlay.trajectory[loop.from].T_map_base.translation());
      const Point2 to = frame.to_pixel(overlay.trajectory[loop.to].T_map_base.translation());
      if (loop.is_on == is_on) draw_loop(canvas, from, to, loop.weight, is_on, sizes);
    }
  }
  for (const NumberedPlace& place : overlay.numbers) {
    const Point2 at = frame.to_pixel(place.at_m);
    if (is_on_sheet(at)) draw_pin(canvas, at, place.number, sizes);
  }
}

LegendItems graph_items(const GraphOverlay& overlay, const LegendLook& look, double px_per_m) {
  const Proportions sizes = look.sizes;
  const double piece = kPiecePx * sizes.unit;
  const Pen path{.colour = kPathInk, .width = kPathPx * sizes.unit};
  LegendItems items;
  if (!overlay.keyframes.empty()) {
    items.push_back(legend_item(
        "", piece,
        [=](Canvas& canvas, const Point2& left) {
          canvas.line(left, left + Point2(piece, 0.0), path);
          for (const double share : {0.2, 0.5, 0.8}) {
            canvas.circle(left + Point2(share * piece, 0.0), kNodePx * sizes.unit, Fill{kPathInk});
          }
        },
        counted(overlay.keyframes.size(), "keyframe"), look));
  }
  const auto on = static_cast<std::size_t>(
      std::count_if(overlay.loops.begin(), overlay.loops.end(), [](const LoopLine& loop) { return loop.is_on; }));
  const std::size_t off = overlay.loops.size() - on;
  if (on > 0) items.push_back(loops_on_item(counted(on, "loop") + (on == 1 ? " holds" : " hold"), look));
  if (off > 0) items.push_back(loops_off_item(counted(off, "loop") + " switched off", look));
  if (const EllipseScale scale = ellipse_scale(overlay, px_per_m, sizes); scale.every_m > 0.0) {
    items.push_back(ellipse_item(" every " + length_text(scale.every_m), scale.factor, look));
  }
  if (!overlay.doubtful.empty()) {
    items.push_back(legend_item(
        "", piece,
        [=](Canvas& canvas, const Point2& left) {
          const Point2 cap(0.5 * kBandPx * sizes.unit, 0.0);
          const Point2 right = left + Point2(piece, 0.0) - cap;
          canvas.line(left + cap, right, {.colour = kBand, .width = 2.0 * cap.x(), .opacity = 0.8});
          canvas.line(left + cap, right, path);
        },
        "not to be trusted", look));
  }
  return items;
}

void check_graph(const GraphOverlay& overlay) {
  const std::size_t poses = overlay.trajectory.size();
  for (const std::size_t index : overlay.keyframes) check_index(index, poses, "keyframe");
  for (const LoopLine& loop : overlay.loops) check_index(std::max(loop.from, loop.to), poses, "loop");
  for (const PathStretch& part : overlay.doubtful) check_index(std::max(part.from, part.to), poses, "doubtful stretch");
  if (!overlay.covariances.empty() && overlay.covariances.size() != poses) {
    throw InputError(
        fmt::format("there are {} covariances, but the trajectory has {} poses: both must come from one run",
                    overlay.covariances.size(), poses));
  }
}

constexpr MapColours kLoopsMap{colour_for(0x59616c), ink::kCard, colour_for(0xebe9e3)};
constexpr Colour kGlow = colour_for(0xff8a1f);
constexpr Colour kRobot = colour_for(0xd9480f);
constexpr double kWallPx = 1.6;      // in `unit`: side of a wall's square
constexpr double kWallShade = 0.55;  // shade of a wall seen once; further views darken it
constexpr double kRobotPx = 7.0;
constexpr double kGlowPx = 13.0;

/// Squares around points, with accumulating shades.
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
  /// Pixels with centres in between; at least the middle one, if it is on the sheet.
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
  for (const Point2& wall : moment.walls_m) image.add(frame.to_pixel(wall), side, (1.0 - share) * kWallShade);
  draw(canvas, {frame.panel, image.image()});
}

void draw_moved_loops(Canvas& canvas, const MapFrame& frame, const LoopsMoment& moment, const Proportions& sizes) {
  for (const MovedLoop& loop : moment.loops) {
    const Point2 from = frame.to_pixel(loop.from_m);
    const Point2 to = frame.to_pixel(loop.to_m);
    if (loop.glow <= 0.0 || !is_on_sheet(from) || !is_on_sheet(to)) continue;
    const double width = kGlowPx * sizes.unit;
    canvas.line(from, to, {.colour = kGlow, .width = width, .opacity = 0.55 * loop.glow});
    for (const Point2& end : {from, to}) canvas.circle(end, width, Fill{kGlow, 0.45 * loop.glow});
  }
  for (const MovedLoop& loop : moment.loops) {
    draw_loop(canvas, frame.to_pixel(loop.from_m), frame.to_pixel(loop.to_m), loop.weight, loop.is_on, sizes);
  }
}

void draw_driven_path(Canvas& canvas, const MapFrame& frame, const LoopsMoment& moment, double unit) {
  std::vector<Point2> pixels;
  for (const Point2& at_m : moment.path_m) {
    const Point2 at = frame.to_pixel(at_m);
    if (is_on_sheet(at) && (pixels.empty() || (at - pixels.back()).norm() >= 0.8 * unit)) pixels.push_back(at);
  }
  if (pixels.size() > 1) canvas.polyline(std::move(pixels), {.colour = kPathInk, .width = kPathPx * unit});
}

void draw_robot(Canvas& canvas, const MapFrame& frame, const LoopsScene& scene, const LoopsMoment& moment,
                const Proportions& sizes) {
  if (!moment.robot_m) return;
  const Point2 at = frame.to_pixel(*moment.robot_m);
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

Canvas graph_picture(const OccupancyMap& map, const GraphOverlay& overlay, const MapLook& look,
                     const PictureSize& size) {
  check_graph(overlay);
  const MapLayer graph{
      [&](Canvas& canvas, const MapFrame& frame, const Proportions& sizes) {
        draw_graph(canvas, frame, overlay, sizes);
      },
      [&](const LegendLook& legend, double px_per_m) { return graph_items(overlay, legend, px_per_m); }};
  return drawn({"Graph",
                shown_area(map, overlay.trajectory),
                light_theme(kGraphMap.unknown),
                {wall_layer(map, kGraphMap), graph}},
               look, size);
}

Canvas loops_picture(const LoopsScene& scene, const LoopsMoment& moment, const MapLook& look, const PictureSize& size) {
  const auto draw_moment = [&](Canvas& canvas, const MapFrame& frame, const Proportions& sizes) {
    draw_walls(canvas, frame, scene, moment, sizes.unit);
    draw_driven_path(canvas, frame, moment, sizes.unit);
    draw_moved_loops(canvas, frame, moment, sizes);
    draw_robot(canvas, frame, scene, moment, sizes);
  };
  const auto explain = [&](const LegendLook& legend, double px_per_m) { return loops_legend(scene, px_per_m, legend); };
  return drawn(
      {"Loops", shown_area(*scene.map, scene.extent), light_theme(kLoopsMap.unknown), {{draw_moment, explain}}}, look,
      size);
}

}  // namespace gdtslam
