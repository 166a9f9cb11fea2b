#include "path_layer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <string_view>
#include <utility>

#include "gdtslam/core/error.hpp"

namespace gdtslam::picture {
namespace {

constexpr int kPathBands = 64;      ///< of colours along a path
constexpr double kEndRadius = 8.0;  // all of one unit
constexpr double kRingRadius = 9.0;
constexpr double kKeyframeRadius = 2.1;

/// Whether it can be drawn. False for what is not finite.
bool is_drawable(const MapFrame& frame, const Pose2& pose) {
  const Point2 at = frame.pixel_of(pose.translation());
  return pose.is_finite() && std::fabs(at.x()) <= kFarthest_px && std::fabs(at.y()) <= kFarthest_px;
}

/// What is drawn of the path: no two points nearer than can be seen, so that a robot that stands costs nothing.
struct PathPoint {
  Point2 at;
  double share = 0.0;
};
std::vector<PathPoint> seen_points(const MapFrame& frame, const Trajectory& trajectory,
                                   const std::vector<double>& shares, std::size_t begin, std::size_t end,
                                   double least_px) {
  std::vector<PathPoint> points;
  for (std::size_t i = begin; i < end; ++i) {
    if (!is_drawable(frame, trajectory[i].T_map_base)) continue;
    const Point2 at = frame.pixel_of(trajectory[i].T_map_base.translation());
    const bool is_last = i + 1 == end;
    if (points.empty() || is_last || (at - points.back().at).norm() >= least_px) points.push_back({at, shares[i]});
  }
  return points;
}

constexpr int kNoBand = -1;  ///< of what has no value
int band_of(double share) {
  return std::isfinite(share) ? static_cast<int>(std::clamp(share * kPathBands, 0.0, kPathBands - 1.0)) : kNoBand;
}

/// A line for each band of values.
void draw_line(Canvas& canvas, const std::vector<PathPoint>& points, const std::function<Colour(double)>& colour_at,
               double width) {
  std::size_t begin = 0;
  while (begin + 1 < points.size()) {
    const int band = band_of(points[begin].share);
    std::vector<Point2> piece{points[begin].at};
    std::size_t end = begin;
    while (end + 1 < points.size() && band_of(points[end].share) == band) piece.push_back(points[++end].at);
    const double share = band == kNoBand ? std::numeric_limits<double>::quiet_NaN() : (band + 0.5) / kPathBands;
    canvas.polyline(std::move(piece), {.colour = colour_at(share), .width = width});
    begin = end;
  }
}

std::vector<std::vector<PathPoint>> seen_pieces(const MapFrame& frame, const Trajectory& trajectory,
                                                const std::vector<std::size_t>& drives,
                                                const std::vector<double>& shares, double least_px) {
  std::vector<std::vector<PathPoint>> pieces;
  const std::vector<std::size_t> ends = ends_of_drives(drives, trajectory.size());
  for (std::size_t k = 1; k < ends.size(); ++k) {
    pieces.push_back(seen_points(frame, trajectory, shares, ends[k - 1], ends[k], least_px));
    if (pieces.back().empty()) pieces.pop_back();
  }
  return pieces;
}

void draw_pieces(Canvas& canvas, const std::vector<std::vector<PathPoint>>& pieces,
                 const std::function<Colour(double)>& colour_at, const ValueLine& line) {
  for (const std::vector<PathPoint>& points : pieces) {
    if (points.size() < 2) continue;
    std::vector<Point2> whole;
    whole.reserve(points.size());
    for (const PathPoint& point : points) whole.push_back(point.at);
    canvas.polyline(std::move(whole), {.colour = line.halo, .width = 2.3 * line.width_px, .opacity = 0.8});
    draw_line(canvas, points, colour_at, line.width_px);
  }
}

/// Scans that would be drawn over each other, as one.
struct Cluster {
  Point2 sum = Point2::Zero();
  std::size_t count = 0;
  [[nodiscard]] Point2 centre() const { return sum / static_cast<double>(count); }
};
std::vector<Cluster> clusters_of(const MapFrame& frame, const PathOverlay& overlay, double reach_px) {
  std::vector<Cluster> clusters;
  for (const std::size_t index : overlay.doubtful) {
    const Pose2& pose = overlay.trajectory[index].T_map_base;
    if (!is_drawable(frame, pose)) continue;
    const Point2 at = frame.pixel_of(pose.translation());
    auto near = std::find_if(clusters.begin(), clusters.end(),
                             [&](const Cluster& cluster) { return (cluster.centre() - at).norm() < reach_px; });
    if (near == clusters.end()) near = clusters.insert(clusters.end(), Cluster{});
    near->sum += at;
    ++near->count;
  }
  return clusters;
}

void draw_doubtful_scans(Canvas& canvas, const MapFrame& frame, const PathOverlay& overlay, const PathColours& colours,
                         const Proportions& sizes) {
  const double radius = kRingRadius * sizes.unit;
  for (const Cluster& cluster : clusters_of(frame, overlay, 1.6 * radius)) {
    draw_doubtful(canvas, cluster.centre(), colours, sizes);
    if (cluster.count < 2) continue;
    const Point2 at = cluster.centre() + Point2(radius + 0.3 * sizes.small_px, -0.5 * radius);
    canvas.text(at, std::to_string(cluster.count),
                {.size = 0.9 * sizes.small_px,
                 .colour = colours.doubtful,
                 .is_bold = true,
                 .has_halo = true,
                 .halo = colours.halo});
  }
}

void draw_keyframes(Canvas& canvas, const MapFrame& frame, const PathOverlay& overlay, const PathColours& colours,
                    const Proportions& sizes) {
  const double apart = 2.0 * kKeyframeRadius * sizes.unit;  // those of a robot that turns on the spot are one dot
  const std::vector<double> shares = time_shares(overlay.trajectory);
  std::set<std::pair<std::int64_t, std::int64_t>> taken;
  for (const std::size_t index : overlay.keyframes) {
    const Pose2& pose = overlay.trajectory[index].T_map_base;
    if (!is_drawable(frame, pose)) continue;
    const Point2 at = frame.pixel_of(pose.translation());
    const std::pair key{static_cast<std::int64_t>(std::floor(at.x() / apart)),
                        static_cast<std::int64_t>(std::floor(at.y() / apart))};
    if (taken.insert(key).second) draw_keyframe(canvas, at, keyframe_colour(colours, shares[index]), sizes);
  }
}

void check_indices(const std::vector<std::size_t>& indices, std::size_t count, std::string_view what) {
  for (const std::size_t index : indices) {
    if (index < count) continue;
    throw InputError("a " + std::string(what) + " has index " + std::to_string(index) + ", but the trajectory has " +
                     std::to_string(count) + " poses: both must come from one run");
  }
}

}  // namespace

const PathColours& path_colours(bool is_dark) {
  static const PathColours light{
      {colour_for(0x0a42d4), colour_for(0x8440be), colour_for(0xcb3596), colour_for(0xe65c3a), colour_for(0xf5970f)},
      ink::kCard,
      colour_for(0x1c2340),
      colour_for(0x000000)};
  static const PathColours dark{
      {colour_for(0x3f9bff), colour_for(0x9a86ff), colour_for(0xef6cc0), colour_for(0xff8a6a), colour_for(0xffc04a)},
      ink::kNight,
      colour_for(0xffffff),
      colour_for(0xffffff)};
  return is_dark ? dark : light;
}

PathColours path_colours(const ColourMap& map, bool is_dark) {
  constexpr int kPathColours = 33;
  PathColours colours = path_colours(is_dark);
  colours.time.clear();
  for (int k = 0; k < kPathColours; ++k) colours.time.push_back(map.at(static_cast<double>(k) / (kPathColours - 1)));
  return colours;
}

std::uint8_t mixed(std::uint8_t from, std::uint8_t to, double share) {
  return static_cast<std::uint8_t>(std::floor(from + share * (static_cast<double>(to) - from) + 0.5));
}

Colour mixed(Colour from, Colour to, double share) {
  return {mixed(from.red, to.red, share), mixed(from.green, to.green, share), mixed(from.blue, to.blue, share)};
}

Colour time_colour(const PathColours& colours, double share) {
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(colours.time.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(position), colours.time.size() - 2);
  const double part = position - static_cast<double>(i);
  return mixed(colours.time[i], colours.time[i + 1], part);
}

Colour keyframe_colour(const PathColours& colours, double share) {
  constexpr double kInkShare = 0.4;
  return mixed(time_colour(colours, share), colours.ink, kInkShare);
}

void check(const PathOverlay& overlay) {
  check_indices(overlay.keyframes, overlay.trajectory.size(), "keyframe");
  check_indices(overlay.doubtful, overlay.trajectory.size(), "doubtful scan");
  check_indices(overlay.drives, overlay.trajectory.size(), "drive");
}

std::vector<std::size_t> ends_of_drives(const std::vector<std::size_t>& drives, std::size_t count) {
  std::vector<std::size_t> ends{0};
  for (const std::size_t drive : drives) {
    if (drive > ends.back() && drive < count) ends.push_back(drive);
  }
  ends.push_back(count);
  return ends;
}

std::vector<double> time_shares(const Trajectory& trajectory) {
  std::vector<double> shares;
  const double whole_s = duration_s(trajectory);
  double elapsed_s = 0.0;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    // Where stamps say nothing, the order does.
    if (whole_s > 0.0) elapsed_s = std::max(elapsed_s, trajectory[i].stamp_s - trajectory.front().stamp_s);
    const double by_order =
        static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(1, trajectory.size() - 1));
    shares.push_back(whole_s > 0.0 ? elapsed_s / whole_s : by_order);
  }
  return shares;
}

double duration_s(const Trajectory& trajectory) {
  double latest_s = 0.0;
  for (const StampedPose& pose : trajectory) {
    if (!std::isfinite(pose.stamp_s)) return 0.0;
    latest_s = std::max(latest_s, pose.stamp_s - trajectory.front().stamp_s);
  }
  return latest_s;
}

void draw_path(Canvas& canvas, const MapFrame& frame, const PathOverlay& overlay, const MapLook& look,
               const PathColours& colours, const Proportions& sizes) {
  const Panel& panel = frame.panel;
  const std::vector<std::vector<PathPoint>> pieces =
      seen_pieces(frame, overlay.trajectory, overlay.drives, time_shares(overlay.trajectory), 0.8 * sizes.unit);
  canvas.begin_clip({panel.left_px, panel.top_px}, panel.width_px, panel.height_px);
  if (look.with_path) {
    const auto colour_at = [&colours](double share) { return time_colour(colours, share); };
    draw_pieces(canvas, pieces, colour_at, {colours.halo, sizes.line_px});
  }
  if (look.with_keyframes) draw_keyframes(canvas, frame, overlay, colours, sizes);
  if (look.with_path && !pieces.empty()) {
    draw_start(canvas, pieces.front().front().at, colours, sizes);
    draw_end(canvas, pieces.back().back().at, colours, sizes);
  }
  draw_doubtful_scans(canvas, frame, overlay, colours, sizes);
  canvas.end_clip();
}

void draw_line_of_values(Canvas& canvas, const MapFrame& frame, const PathOfValues& path,
                         const std::function<Colour(double)>& colour_at, const ValueLine& line) {
  constexpr double kLeastStep = 0.35;  // of the line's width
  const Panel& panel = frame.panel;
  canvas.begin_clip({panel.left_px, panel.top_px}, panel.width_px, panel.height_px);
  draw_pieces(canvas, seen_pieces(frame, path.trajectory, path.drives, path.shares, kLeastStep * line.width_px),
              colour_at, line);
  canvas.end_clip();
}

void draw_start(Canvas& canvas, const Point2& centre, const PathColours& colours, const Proportions& sizes) {
  canvas.circle(centre, kEndRadius * sizes.unit, Fill{time_colour(colours, 0.0)},
                Pen{.colour = colours.halo, .width = 2.0 * sizes.unit});
}

void draw_end(Canvas& canvas, const Point2& centre, const PathColours& colours, const Proportions& sizes) {
  const double radius = kEndRadius * sizes.unit;
  canvas.circle(centre, radius + sizes.unit, Fill{colours.halo});
  canvas.circle(centre, 0.75 * radius, Fill{colours.halo},
                Pen{.colour = time_colour(colours, 1.0), .width = 0.5 * radius});
}

void draw_keyframe(Canvas& canvas, const Point2& centre, Colour colour, const Proportions& sizes) {
  canvas.circle(centre, kKeyframeRadius * sizes.unit, Fill{colour});
}

void draw_doubtful(Canvas& canvas, const Point2& centre, const PathColours& colours, const Proportions& sizes) {
  const double radius = kRingRadius * sizes.unit;
  canvas.circle(centre, radius, std::nullopt, Pen{.colour = colours.halo, .width = 5.5 * sizes.unit, .opacity = 0.9});
  canvas.circle(centre, radius, std::nullopt, Pen{.colour = colours.doubtful, .width = 2.6 * sizes.unit});
}

}  // namespace gdtslam::picture
