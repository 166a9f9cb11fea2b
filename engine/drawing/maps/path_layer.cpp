#include "path_layer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>

#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/ticks.hpp"

namespace gdtslam::picture {
namespace {

constexpr int kPathBands = 64;      ///< bands of colour along a path
constexpr double kEndRadius = 8.0;  // all of one unit
constexpr double kRingRadius = 9.0;
constexpr double kKeyframeRadius = 2.1;
constexpr double kKeyframeInk = 0.4;

struct PathPoint {
  Point2 at;
  double share = 0.0;
};

constexpr int kNoBand = -1;  ///< band of a pose without a value
int colour_band(double share) {
  return std::isfinite(share) ? static_cast<int>(std::clamp(share * kPathBands, 0.0, kPathBands - 1.0)) : kNoBand;
}

/// Draws a line for each band of values.
void draw_line(Canvas& canvas, const std::vector<PathPoint>& points, const std::function<Colour(double)>& colour_at,
               double width) {
  std::size_t begin = 0;
  while (begin + 1 < points.size()) {
    const int band = colour_band(points[begin].share);
    std::vector<Point2> piece{points[begin].at};
    std::size_t end = begin;
    while (end + 1 < points.size() && colour_band(points[end].share) == band) piece.push_back(points[++end].at);
    const double share = band == kNoBand ? std::numeric_limits<double>::quiet_NaN() : (band + 0.5) / kPathBands;
    canvas.polyline(std::move(piece), {.colour = colour_at(share), .width = width});
    begin = end;
  }
}

/// The index at which each drive begins, then the count.
std::vector<std::size_t> ends_of_drives(const std::vector<std::size_t>& drives, std::size_t count) {
  std::vector<std::size_t> ends{0};
  for (const std::size_t drive : drives) {
    if (drive > ends.back() && drive < count) ends.push_back(drive);
  }
  ends.push_back(count);
  return ends;
}

/// Overlapping scans drawn as one.
struct Cluster {
  Point2 sum = Point2::Zero();
  std::size_t count = 0;
  [[nodiscard]] Point2 centre() const { return sum / static_cast<double>(count); }
};
std::vector<Cluster> find_clusters(const MapFrame& frame, const PathOverlay& overlay, double reach_px) {
  std::vector<Cluster> clusters;
  for (const std::size_t index : overlay.doubtful) {
    const Point2 at = frame.to_pixel(overlay.trajectory[index].T_map_base.translation());
    if (!is_on_sheet(at)) continue;
    auto near = std::find_if(clusters.begin(), clusters.end(),
                             [&](const Cluster& cluster) { return (cluster.centre() - at).norm() < reach_px; });
    if (near == clusters.end()) near = clusters.insert(clusters.end(), Cluster{});
    near->sum += at;
    ++near->count;
  }
  return clusters;
}

Colour keyframe_colour(const PathColours& colours, double share) {
  return mixed(time_colour(colours, share), colours.ink, kKeyframeInk);
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

void draw_doubtful(Canvas& canvas, const Point2& centre, const PathColours& colours, const Proportions& sizes) {
  const double radius = kRingRadius * sizes.unit;
  canvas.circle(centre, radius, std::nullopt, Pen{.colour = colours.halo, .width = 5.5 * sizes.unit, .opacity = 0.9});
  canvas.circle(centre, radius, std::nullopt, Pen{.colour = colours.doubtful, .width = 2.6 * sizes.unit});
}

void draw_doubtful_scans(Canvas& canvas, const MapFrame& frame, const PathOverlay& overlay, const PathColours& colours,
                         const Proportions& sizes) {
  const double radius = kRingRadius * sizes.unit;
  const Lettering letters{.size = 0.9 * sizes.small_px,
                          .colour = colours.doubtful,
                          .is_bold = true,
                          .has_halo = true,
                          .halo = colours.halo};
  for (const Cluster& cluster : find_clusters(frame, overlay, 1.6 * radius)) {
    draw_doubtful(canvas, cluster.centre(), colours, sizes);
    const Point2 beside = cluster.centre() + Point2(radius + 0.3 * sizes.small_px, -0.5 * radius);
    if (cluster.count > 1) canvas.text(beside, std::to_string(cluster.count), letters);
  }
}

void draw_path(Canvas& canvas, const MapFrame& frame, const PathOverlay& overlay, const MapLook& look,
               const PathColours& colours, const Proportions& sizes) {
  const Trajectory& trajectory = overlay.trajectory;
  const std::vector<double> shares = time_shares(trajectory);
  if (look.with_path) {
    const auto colour_at = [&colours](double share) { return time_colour(colours, share); };
    draw_line_of_values(canvas, frame, {trajectory, overlay.drives, shares}, colour_at, {colours.halo, sizes.line_px});
  }
  if (look.with_keyframes) {
    draw_dots(canvas, frame, trajectory, overlay.keyframes, kKeyframeRadius * sizes.unit,
              [&](std::size_t index) { return keyframe_colour(colours, shares[index]); });
  }
  const std::vector<SeenPose> ends = seen_poses(frame, trajectory, 0, trajectory.size(), kFarthest_px);
  if (look.with_path && !ends.empty()) {
    draw_start(canvas, ends.front().at, colours, sizes);
    draw_end(canvas, ends.back().at, colours, sizes);
  }
  draw_doubtful_scans(canvas, frame, overlay, colours, sizes);
}

double duration_s(const Trajectory& trajectory) {
  double latest_s = 0.0;
  for (const StampedPose& pose : trajectory) {
    if (!std::isfinite(pose.stamp_s)) return 0.0;
    latest_s = std::max(latest_s, pose.stamp_s - trajectory.front().stamp_s);
  }
  return latest_s;
}

LegendItem time_item(double seconds, const PathColours& colours, const LegendLook& look) {
  const Proportions sizes = look.sizes;
  const double pad = kEndRadius * sizes.unit;
  const double bar = 150.0 * sizes.unit;
  return legend_item(
      "start", bar + 2.0 * pad,
      [=, &colours](Canvas& canvas, const Point2& left) {
        const Point2 from = left + Point2(pad, 0.0);
        std::vector<PathPoint> points;
        for (int i = 0; i <= kPathBands; ++i) {
          const double share = static_cast<double>(i) / kPathBands;
          points.push_back({from + Point2(bar * share, 0.0), share});
        }
        draw_line(
            canvas, points, [&](double share) { return time_colour(colours, share); }, 2.0 * sizes.line_px);
        draw_start(canvas, from, colours, sizes);
        draw_end(canvas, from + Point2(bar, 0.0), colours, sizes);
      },
      seconds > 0.0 ? "end, after " + duration_text(seconds) : "end", look);
}

/// A piece of the path with keyframes, because single dots would be too small to recognise.
LegendItem keyframe_item(const std::string& words, const PathColours& colours, const LegendLook& look) {
  const Proportions sizes = look.sizes;
  const double piece = 42.0 * sizes.unit;
  return legend_item(
      "", piece,
      [=, &colours](Canvas& canvas, const Point2& left) {
        canvas.line(left, left + Point2(piece, 0.0), {.colour = time_colour(colours, 0.5), .width = sizes.line_px});
        for (const double at : {0.2, 0.5, 0.8}) {
          canvas.circle(left + Point2(at * piece, 0.0), kKeyframeRadius * sizes.unit,
                        Fill{keyframe_colour(colours, 0.5)});
        }
      },
      words, look);
}

LegendItems path_items(const PathOverlay& overlay, const MapLook& look, const PathColours& colours,
                       const LegendLook& legend) {
  LegendItems items;
  if (look.with_path && !overlay.trajectory.empty()) {
    items.push_back(time_item(duration_s(overlay.trajectory), colours, legend));
  }
  if (look.with_keyframes && !overlay.keyframes.empty()) {
    items.push_back(keyframe_item(counted(overlay.keyframes.size(), "keyframe"), colours, legend));
  }
  if (!overlay.doubtful.empty()) {
    const double mark = 1.1 * legend.sizes.body_px;
    items.push_back(legend_item(
        "", mark,
        [mark, sizes = legend.sizes, &colours](Canvas& canvas, const Point2& left) {
          draw_doubtful(canvas, left + Point2(0.5 * mark, 0.0), colours, sizes);
        },
        counted(overlay.doubtful.size(), "doubtful scan"), legend));
  }
  if (!items.empty()) items.front().begins_row = true;
  return items;
}

}  // namespace

PathColours path_colours(bool is_dark, const std::string& map) {
  constexpr int kPathColours = 33;
  PathColours colours = is_dark ? PathColours{{colour_for(0x3f9bff), colour_for(0x9a86ff), colour_for(0xef6cc0),
                                               colour_for(0xff8a6a), colour_for(0xffc04a)},
                                              ink::kNight,
                                              colour_for(0xffffff),
                                              colour_for(0xffffff)}
                                : PathColours{{colour_for(0x0a42d4), colour_for(0x8440be), colour_for(0xcb3596),
                                               colour_for(0xe65c3a), colour_for(0xf5970f)},
                                              ink::kCard,
                                              colour_for(0x1c2340),
                                              colour_for(0x000000)};
  if (map.empty()) return colours;
  colours.time.clear();
  for (int k = 0; k < kPathColours; ++k) {
    colours.time.push_back(colour_map(map).at(static_cast<double>(k) / (kPathColours - 1)));
  }
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

void check_index(std::size_t index, std::size_t count, const char* what) {
  if (index < count) return;
  throw InputError(std::string("a ") + what + " has index " + std::to_string(index) + ", but the trajectory has " +
                   std::to_string(count) + " poses: both must come from one run");
}

void check(const PathOverlay& overlay) {
  const std::size_t count = overlay.trajectory.size();
  for (const std::size_t index : overlay.keyframes) check_index(index, count, "keyframe");
  for (const std::size_t index : overlay.doubtful) check_index(index, count, "doubtful scan");
  for (const std::size_t index : overlay.drives) check_index(index, count, "drive");
}

std::vector<double> time_shares(const Trajectory& trajectory) {
  std::vector<double> shares;
  const double whole_s = duration_s(trajectory);
  double elapsed_s = 0.0;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    // Without usable stamps, time follows the order.
    if (whole_s > 0.0) elapsed_s = std::max(elapsed_s, trajectory[i].stamp_s - trajectory.front().stamp_s);
    const double by_order =
        static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(1, trajectory.size() - 1));
    shares.push_back(whole_s > 0.0 ? elapsed_s / whole_s : by_order);
  }
  return shares;
}

std::vector<SeenPose> seen_poses(const MapFrame& frame, const Trajectory& trajectory, std::size_t begin,
                                 std::size_t end, double least_px) {
  std::vector<SeenPose> seen;
  for (std::size_t i = begin; i < end; ++i) {
    const Point2 at = frame.to_pixel(trajectory[i].T_map_base.translation());
    if (!is_on_sheet(at)) continue;
    if (seen.empty() || i + 1 == end || (at - seen.back().at).norm() >= least_px) seen.push_back({at, i});
  }
  return seen;
}

void draw_dots(Canvas& canvas, const MapFrame& frame, const Trajectory& trajectory,
               const std::vector<std::size_t>& indices, double radius,
               const std::function<Colour(std::size_t)>& dot_colour) {
  std::set<std::pair<long, long>> taken;
  for (const std::size_t index : indices) {
    const Point2 at = frame.to_pixel(trajectory[index].T_map_base.translation());
    if (!is_on_sheet(at)) continue;
    const std::pair key{std::lround(0.5 * at.x() / radius), std::lround(0.5 * at.y() / radius)};
    if (taken.insert(key).second) canvas.circle(at, radius, Fill{dot_colour(index)});
  }
}

void draw_line_of_values(Canvas& canvas, const MapFrame& frame, const PathOfValues& path,
                         const std::function<Colour(double)>& colour_at, const ValueLine& line) {
  constexpr double kLeastStep = 0.35;  // in widths of the line
  const std::vector<std::size_t> ends = ends_of_drives(path.drives, path.trajectory.size());
  for (std::size_t k = 1; k < ends.size(); ++k) {
    std::vector<Point2> whole;
    std::vector<PathPoint> points;
    for (const SeenPose& pose : seen_poses(frame, path.trajectory, ends[k - 1], ends[k], kLeastStep * line.width_px)) {
      whole.push_back(pose.at);
      points.push_back({pose.at, path.shares.empty() ? 0.0 : path.shares[pose.index]});
    }
    if (whole.size() < 2) continue;
    if (line.halo) {
      canvas.polyline(std::move(whole), {.colour = *line.halo, .width = 2.3 * line.width_px, .opacity = 0.8});
    }
    draw_line(canvas, points, colour_at, line.width_px);
  }
}

MapLayer path_layer(const PathOverlay& overlay, const MapLook& look, const PathColours& colours) {
  return {[&](Canvas& canvas, const MapFrame& frame, const Proportions& sizes) {
            draw_path(canvas, frame, overlay, look, colours, sizes);
          },
          [&](const LegendLook& legend, double /*px_per_m*/) { return path_items(overlay, look, colours, legend); }};
}

MapLayer line_layer(const Trajectory& path, const std::vector<std::size_t>& drives, const std::string& words,
                    Colour colour, const ValueLine& line) {
  return {[&path, &drives, colour, line](Canvas& canvas, const MapFrame& frame, const Proportions& /*sizes*/) {
            draw_line_of_values(
                canvas, frame, {path, drives, {}}, [colour](double /*share*/) { return colour; }, line);
          },
          [words, colour, line](const LegendLook& legend, double /*px_per_m*/) {
            return LegendItems{line_item(words, {.colour = colour, .width = line.width_px}, legend)};
          }};
}

}  // namespace gdtslam::picture
