#include "graph_layer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/ticks.hpp"
#include "path_layer.hpp"

namespace gdtslam::picture {
namespace {

constexpr double kEllipsePx = 30.0;     // times `unit`: the largest that is enlarged,
constexpr double kEllipseStep = 56.0;   // from one to the next along the path,
constexpr double kEllipseApart = 26.0;  // and of those of other visits
constexpr double kMostEnlarged = 1.0e4;
constexpr int kEllipsePoints = 48;
constexpr double kLoopPx = 2.6;
constexpr double kLoopEndPx = 3.4;
constexpr double kBandPx = 15.0;
constexpr double kPiecePx = 46.0;  // of what a legend shows of a line
constexpr double kPinPx = 13.0;
constexpr double kLeastWeight = 0.25;  // of a loop that holds

constexpr Colour kWeakLoop = colour_for(0x8fc9f2);
constexpr Colour kStrongLoop = colour_for(0x0b4fa8);
constexpr Colour kEllipseInk = colour_for(0x8a3f86);
constexpr Colour kBand = colour_for(0xffb52e);
constexpr std::string_view kDashes = "7 5";

Colour loop_colour(double weight) {
  return mixed(kWeakLoop, kStrongLoop, std::clamp((weight - kLeastWeight) / (1.0 - kLeastWeight), 0.0, 1.0));
}

Point2 pixel_of_pose(const MapFrame& frame, const GraphOverlay& overlay, std::size_t index) {
  return frame.pixel_of(overlay.trajectory[index].T_map_base.translation());
}

std::vector<Point2> pixels_of(const MapFrame& frame, const GraphOverlay& overlay, std::size_t from, std::size_t to,
                              double least_px) {
  std::vector<Point2> points;
  for (std::size_t i = from; i <= to; ++i) {
    const Point2 at = pixel_of_pose(frame, overlay, i);
    if (!is_on_sheet(at)) continue;
    if (points.empty() || i == to || (at - points.back()).norm() >= least_px) points.push_back(at);
  }
  return points;
}

/// The points of a covariance's ellipse around its pose, by the covariance's own root.
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

/// Of the poses every so many metres, in each place the one that is least sure.
std::vector<std::size_t> ellipse_poses(const MapFrame& frame, const GraphOverlay& overlay, double every_m,
                                       double apart_px) {
  std::map<std::pair<long, long>, std::size_t> taken;
  double since_m = every_m;
  for (std::size_t i = 0; i < overlay.covariances.size(); ++i) {
    if (i > 0) {
      since_m += between(overlay.trajectory[i - 1].T_map_base, overlay.trajectory[i].T_map_base).translation().norm();
    }
    const Point2 at = pixel_of_pose(frame, overlay, i);
    if (since_m < every_m || !is_on_sheet(at)) continue;
    since_m = 0.0;
    const std::pair key{std::lround(at.x() / apart_px), std::lround(at.y() / apart_px)};
    const auto [place, is_new] = taken.try_emplace(key, i);
    if (!is_new && overlay.covariances[i].sigma_m() > overlay.covariances[place->second].sigma_m()) place->second = i;
  }
  std::vector<std::size_t> poses;
  poses.reserve(taken.size());
  for (const auto& [key, index] : taken) poses.push_back(index);
  return poses;
}

void draw_ellipses(Canvas& canvas, const MapFrame& frame, const GraphOverlay& overlay, const Proportions& sizes) {
  const EllipseScale scale = ellipse_scale(overlay, frame.px_per_m, sizes);
  if (scale.every_m <= 0.0) return;
  const double px_per_sigma = kSigmas * scale.factor * frame.px_per_m;
  for (const std::size_t i : ellipse_poses(frame, overlay, scale.every_m, kEllipseApart * sizes.unit)) {
    draw_ellipse(canvas, pixel_of_pose(frame, overlay, i), overlay.covariances[i], px_per_sigma, sizes);
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

void draw_nodes(Canvas& canvas, const MapFrame& frame, const GraphOverlay& overlay, const Proportions& sizes) {
  const double apart = 2.0 * kNodePx * sizes.unit;
  std::map<std::pair<long, long>, bool> taken;
  for (const std::size_t index : overlay.keyframes) {
    const Point2 at = pixel_of_pose(frame, overlay, index);
    if (!is_on_sheet(at)) continue;
    if (!taken.try_emplace({std::lround(at.x() / apart), std::lround(at.y() / apart)}, true).second) continue;
    canvas.circle(at, kNodePx * sizes.unit, Fill{kPathInk});
  }
}

std::size_t loops_that(const GraphOverlay& overlay, bool are_on) {
  return static_cast<std::size_t>(std::count_if(overlay.loops.begin(), overlay.loops.end(),
                                                [&](const LoopLine& loop) { return loop.is_on == are_on; }));
}

void add_loop_items(std::vector<LegendItem>& items, const GraphOverlay& overlay, const LegendLook& look) {
  if (const std::size_t on = loops_that(overlay, true); on > 0) {
    items.push_back(loops_on_item(counted(on, "loop") + (on == 1 ? " holds" : " hold"), look));
  }
  if (const std::size_t off = loops_that(overlay, false); off > 0) {
    items.push_back(loops_off_item(counted(off, "loop") + " switched off", look));
  }
}

}  // namespace

bool is_on_sheet(const Point2& at) {
  return std::isfinite(at.x()) && std::isfinite(at.y()) && std::fabs(at.x()) <= kFarthest_px &&
         std::fabs(at.y()) <= kFarthest_px;
}

void draw_loop(Canvas& canvas, const Point2& from, const Point2& to, const LoopLine& loop, const Proportions& sizes) {
  const Colour colour = loop.is_on ? loop_colour(loop.weight) : ink::kWarning;
  canvas.line(from, to,
              {.colour = colour, .width = kLoopPx * sizes.unit, .dashes = loop.is_on ? std::string_view() : kDashes});
  for (const Point2& end : {from, to}) canvas.circle(end, kLoopEndPx * sizes.unit, Fill{colour});
}

void draw_ellipse(Canvas& canvas, const Point2& centre, const PoseCovariance& covariance, double px_per_sigma,
                  const Proportions& sizes) {
  std::vector<Point2> points = ellipse_around(centre, covariance, px_per_sigma);
  if (!std::all_of(points.begin(), points.end(), is_on_sheet)) return;
  canvas.polygon(points, Fill{kEllipseInk, 0.10});
  canvas.polyline(std::move(points), {.colour = kEllipseInk, .width = 1.3 * sizes.unit, .opacity = 0.9});
}

LegendItem graph_item(const std::string& words, double mark_px, const LegendLook& look,
                      std::function<void(Canvas&, const Point2&)> draw_mark) {
  const double size = look.sizes.body_px;
  const double indent = mark_px + 0.5 * size;
  return {indent + text_width(words, size), size,
          [words, indent, size, &look, draw_mark = std::move(draw_mark)](Canvas& canvas, const Point2& left) {
            draw_mark(canvas, left);
            canvas.text({left.x() + indent, left.y() + 0.36 * size}, words, {.size = size, .colour = look.theme.text});
          }};
}

LegendItem loops_on_item(const std::string& words, const LegendLook& look) {
  const auto colour_at = [](double share) { return loop_colour(kLeastWeight + share * (1.0 - kLeastWeight)); };
  return colour_bar_item(words + ", weight 0.25", "1", colour_at, look);
}

LegendItem loops_off_item(const std::string& words, const LegendLook& look) {
  const double piece = kPiecePx * look.sizes.unit;
  return graph_item(words, piece, look, [piece, sizes = look.sizes](Canvas& canvas, const Point2& left) {
    draw_loop(canvas, left, left + Point2(piece, 0.0), {.weight = 0.0, .is_on = false}, sizes);
  });
}

LegendItem ellipse_item(const std::string& words, const LegendLook& look) {
  const double share = 0.3 * kPiecePx * look.sizes.unit;
  return graph_item(words, 2.0 * share, look, [share, sizes = look.sizes](Canvas& canvas, const Point2& left) {
    draw_ellipse(canvas, left + Point2(share, 0.0), {.xx = 1.0, .xy = 0.25, .yy = 0.35}, share, sizes);
  });
}

/// In the most words that there is room for.
LegendItem fitting_ellipse_item(const EllipseScale& scale, const LegendLook& look) {
  const std::string every = length_text(scale.every_m);
  const bool is_enlarged = scale.factor > 1.0;
  LegendItem item;
  for (const char* of : {" of the position every ", " every "}) {
    for (const char* times : {", drawn {:g} times as large", ", {:g} times as large"}) {
      std::string words = "3 sigma" + (of + every);
      if (is_enlarged) words += fmt::format(fmt::runtime(times), scale.factor);
      item = ellipse_item(words, look);
      if (item.width_px <= look.room_px) return item;
    }
  }
  return item;
}

double ellipse_factor(double sigma_m, double px_per_m, const Proportions& sizes) {
  return std::clamp(round_length_m(kEllipsePx * sizes.unit / (kSigmas * sigma_m * px_per_m)), 1.0, kMostEnlarged);
}

void check(const GraphOverlay& overlay) {
  const std::size_t poses = overlay.trajectory.size();
  const auto require = [poses](std::size_t index, const char* what) {
    if (index < poses) return;
    throw InputError(fmt::format("a {} has index {}, but the trajectory has {} poses: both must come from one run",
                                 what, index, poses));
  };
  for (const std::size_t index : overlay.keyframes) require(index, "keyframe");
  for (const LoopLine& loop : overlay.loops) require(std::max(loop.from, loop.to), "loop");
  for (const PathStretch& stretch : overlay.doubtful) require(std::max(stretch.from, stretch.to), "doubtful stretch");
  if (!overlay.covariances.empty() && overlay.covariances.size() != poses) {
    throw InputError(
        fmt::format("there are {} covariances, but the trajectory has {} poses: both must come from one run",
                    overlay.covariances.size(), poses));
  }
}

EllipseScale ellipse_scale(const GraphOverlay& overlay, double px_per_m, const Proportions& sizes) {
  EllipseScale scale;
  double sigma_m = 0.0;
  for (const PoseCovariance& covariance : overlay.covariances) sigma_m = std::max(sigma_m, covariance.sigma_m());
  if (!(sigma_m > 0.0) || !std::isfinite(sigma_m)) return scale;
  scale.every_m = round_length_m(2.0 * kEllipseStep * sizes.unit / px_per_m);
  scale.factor = ellipse_factor(sigma_m, px_per_m, sizes);
  return scale;
}

void draw_graph(Canvas& canvas, const MapFrame& frame, const GraphOverlay& overlay, const Proportions& sizes) {
  const Panel& panel = frame.panel;
  canvas.begin_clip({panel.left_px, panel.top_px}, panel.width_px, panel.height_px);
  for (const PathStretch& stretch : overlay.doubtful) {
    std::vector<Point2> band = pixels_of(frame, overlay, stretch.from, stretch.to, sizes.unit);
    if (band.size() == 1) canvas.circle(band.front(), 0.5 * kBandPx * sizes.unit, Fill{kBand, 0.8});
    if (band.size() > 1) {
      canvas.polyline(std::move(band), {.colour = kBand, .width = kBandPx * sizes.unit, .opacity = 0.8});
    }
  }
  const std::vector<std::size_t> ends = ends_of_drives(overlay.drives, overlay.trajectory.size());
  for (std::size_t k = 1; k < ends.size() && !overlay.trajectory.empty(); ++k) {
    std::vector<Point2> path = pixels_of(frame, overlay, ends[k - 1], ends[k] - 1, 0.8 * sizes.unit);
    if (path.size() > 1) canvas.polyline(std::move(path), {.colour = kPathInk, .width = kPathPx * sizes.unit});
  }
  draw_nodes(canvas, frame, overlay, sizes);
  draw_ellipses(canvas, frame, overlay, sizes);
  for (const bool is_on : {true, false}) {  // those that nobody believes on top: there are few
    for (const LoopLine& loop : overlay.loops) {
      const Point2 from = pixel_of_pose(frame, overlay, loop.from);
      const Point2 to = pixel_of_pose(frame, overlay, loop.to);
      if (loop.is_on == is_on && is_on_sheet(from) && is_on_sheet(to)) draw_loop(canvas, from, to, loop, sizes);
    }
  }
  for (const NumberedPlace& place : overlay.numbers) {
    const Point2 at = frame.pixel_of(place.at_m);
    if (is_on_sheet(at)) draw_pin(canvas, at, place.number, sizes);
  }
  canvas.end_clip();
}

void add_graph_items(std::vector<LegendItem>& items, const GraphOverlay& overlay, double px_per_m,
                     const LegendLook& look) {
  const Proportions sizes = look.sizes;
  const double piece = kPiecePx * sizes.unit;
  if (!overlay.keyframes.empty()) {
    items.push_back(
        graph_item(counted(overlay.keyframes.size(), "keyframe"), piece, look, [=](Canvas& canvas, const Point2& left) {
          canvas.line(left, left + Point2(piece, 0.0), {.colour = kPathInk, .width = kPathPx * sizes.unit});
          for (const double share : {0.2, 0.5, 0.8}) {
            canvas.circle(left + Point2(share * piece, 0.0), kNodePx * sizes.unit, Fill{kPathInk});
          }
        }));
  }
  add_loop_items(items, overlay, look);
  if (const EllipseScale scale = ellipse_scale(overlay, px_per_m, sizes); scale.every_m > 0.0) {
    items.push_back(fitting_ellipse_item(scale, look));
  }
  if (!overlay.doubtful.empty()) {
    items.push_back(graph_item("not to be trusted", piece, look, [=](Canvas& canvas, const Point2& left) {
      const Point2 begin = left + Point2(0.5 * kBandPx * sizes.unit, 0.0);
      const Point2 end = left + Point2(piece - 0.5 * kBandPx * sizes.unit, 0.0);
      canvas.line(begin, end, {.colour = kBand, .width = kBandPx * sizes.unit, .opacity = 0.8});
      canvas.line(begin, end, {.colour = kPathInk, .width = kPathPx * sizes.unit});
    }));
  }
}

}  // namespace gdtslam::picture
