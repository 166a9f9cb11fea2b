// Draws poses found in a map over pale walls: arrows, or a path if they follow each other.
#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/elementary.hpp"
#include "engine/drawing/maps/cell_image.hpp"
#include "engine/drawing/maps/map_sheet.hpp"
#include "tools/gdtslam/localize/localize.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

using namespace picture;

constexpr MapColours kPosesMap{colour_for(0x8e949c), ink::kCard, colour_for(0xebe9e3)};
constexpr double kArrowLines = 6.0;  // length, in line widths
constexpr double kLeap_m = 1.0;      // poses farther apart are not joined by a line

/// Certainty of a pose: blue, amber and red. A later kind is drawn above the ones before it.
enum class PoseKind : std::uint8_t { kSure, kOpen, kPoor };
constexpr std::array kPoseKinds{PoseKind::kSure, PoseKind::kOpen, PoseKind::kPoor};

struct ShownPose {
  Pose2 T_map_base;
  PoseKind kind = PoseKind::kSure;
  std::optional<Pose2> other{};  ///< another pose that may be as good: hollow, at the end of a dashed line
};

struct PosesOverlay {
  std::vector<ShownPose> poses;
  bool are_path = false;             ///< poses of one robot, in order
  std::array<std::string, 3> words;  ///< name of each kind in the legend, which counts them
};

Colour colour_of_kind(PoseKind kind) {
  static constexpr std::array<Colour, kPoseKinds.size()> kKindColours{ink::kCoupler, ink::kLaser, ink::kWarning};
  return kKindColours.at(static_cast<std::size_t>(kind));
}

// Draws a slim arrow head with a notched tail; the pose is at its middle.
void draw_arrow(Canvas& canvas, const Point2& at, double theta_rad, double length, PoseKind kind, bool is_hollow) {
  const auto [sin, cos] = sin_cos(theta_rad);
  const Point2 forward(cos, -sin);
  const Point2 left(-sin, -cos);
  std::vector<Point2> outline{at + 0.6 * length * forward, at - 0.4 * length * forward + 0.36 * length * left,
                              at - 0.2 * length * forward, at - 0.4 * length * forward - 0.36 * length * left};
  canvas.polygon(outline, {is_hollow ? ink::kCard : colour_of_kind(kind), 0.9});
  outline.push_back(outline.front());
  canvas.polyline(std::move(outline), {.colour = is_hollow ? colour_of_kind(kind) : ink::kCard,
                                       .width = (is_hollow ? 0.12 : 0.05) * length});
}

void draw_arrows(Canvas& canvas, const MapFrame& frame, const PosesOverlay& overlay, PoseKind kind, double line_px) {
  const double length = kArrowLines * line_px;
  for (const ShownPose& pose : overlay.poses) {
    if (pose.kind != kind) continue;
    const Point2 at = frame.to_pixel(pose.T_map_base.translation());
    if (pose.other) {
      const Point2 there = frame.to_pixel(pose.other->translation());
      canvas.line(at, there, {.colour = colour_of_kind(kind), .width = 0.5 * line_px, .dashes = "4 3"});
      draw_arrow(canvas, there, pose.other->theta_rad, length, kind, true);
    }
    draw_arrow(canvas, at, pose.T_map_base.theta_rad, length, kind, false);
  }
}

void draw_steps(Canvas& canvas, const MapFrame& frame, const PosesOverlay& overlay, PoseKind kind, double line_px) {
  const Pen pen{.colour = colour_of_kind(kind), .width = line_px, .opacity = 0.9};
  std::vector<Point2> line;
  const auto close = [&] {
    if (line.size() > 1) canvas.polyline(line, pen);
    line.clear();
  };
  const ShownPose* before = nullptr;
  for (const ShownPose& pose : overlay.poses) {
    const Point2 at_m = pose.T_map_base.translation();
    const bool is_near = before != nullptr && (before->T_map_base.translation() - at_m).norm() < kLeap_m;
    if (pose.kind != kind || !is_near) close();
    if (pose.kind == kind && is_near) {
      if (line.empty()) line.push_back(frame.to_pixel(before->T_map_base.translation()));
      line.push_back(frame.to_pixel(at_m));
    }
    before = &pose;
  }
  close();
}

MapLayer poses_layer(const PosesOverlay& overlay, PoseKind kind) {
  MapLayer layer;
  layer.draw = [&overlay, kind](Canvas& canvas, const MapFrame& frame, const Proportions& sizes) {
    (overlay.are_path ? draw_steps : draw_arrows)(canvas, frame, overlay, kind, sizes.line_px);
  };
  layer.explain = [&overlay, kind](const LegendLook& legend, double) -> LegendItems {
    const auto count = std::count_if(overlay.poses.begin(), overlay.poses.end(),
                                     [kind](const ShownPose& pose) { return pose.kind == kind; });
    if (count == 0) return {};
    const std::string& words = overlay.words.at(static_cast<std::size_t>(kind));
    return {swatch_item(words + ": " + std::to_string(count), colour_of_kind(kind), legend)};
  };
  return layer;
}

Canvas poses_picture(const OccupancyMap& map, const PosesOverlay& overlay, const MapLook& look,
                     const PictureSize& size) {
  Theme theme = kLightTheme;
  theme.page = kPosesMap.unknown;
  Trajectory extent;
  for (const ShownPose& pose : overlay.poses) {
    extent.push_back({0.0, pose.T_map_base});
    if (pose.other) extent.push_back({0.0, *pose.other});
  }
  MapSheet sheet{"Poses", shown_area(map, extent), theme, {wall_layer(map, kPosesMap)}};
  for (const PoseKind kind : kPoseKinds) sheet.layers.push_back(poses_layer(overlay, kind));
  return drawn(sheet, look, size);
}

PoseKind pose_kind(const LocalizedScan& scan) {
  if (!scan.is_proven() || scan.verdict == Verdict::kPoorFit) return PoseKind::kPoor;
  return scan.is_ambiguous() ? PoseKind::kOpen : PoseKind::kSure;
}

PoseKind pose_kind(const TrackedPose& pose) {
  if (pose.is_ambiguous || pose.whereabouts == Whereabouts::kFound) return PoseKind::kOpen;
  return pose.whereabouts == Whereabouts::kTracked ? PoseKind::kSure : PoseKind::kPoor;
}

Canvas draw_on_map(const Localizer& localizer, const PosesOverlay& overlay, const MapLook& look) {
  const OccupancyMap map = shown_map(localizer.field());
  return poses_picture(map, overlay, look, size_for_content(map.geometry.width, map.geometry.height));
}

std::string name_of_log(const std::string& log) { return std::filesystem::path(log).filename().string(); }

}  // namespace

Canvas localize_picture(const std::string& log, const Localizer& localizer, const Localized& all) {
  PosesOverlay overlay;
  overlay.words = {"found", "found, but the pose at the dashed line's end may be as good", "a poor fit, or not proven"};
  for (const LocalizedScan& scan : all.scans) {
    if (!scan.best) continue;
    ShownPose& pose = overlay.poses.emplace_back(ShownPose{scan.best->T_map_base, pose_kind(scan)});
    if (pose.kind == PoseKind::kOpen && scan.runner_up) pose.other = scan.runner_up->T_map_base;
  }
  MapLook look;
  look.title = "Scans of " + name_of_log(log) + " found in the map";
  look.subtitle = plural(all.scans.size(), "scan") + ", each searched in the whole map without odometry";
  return draw_on_map(localizer, overlay, look);
}

Canvas localize_picture(const std::string& log, const Localizer& localizer, const TrackedDrive& drive) {
  PosesOverlay overlay;
  overlay.are_path = true;
  overlay.words = {"tracked", "found, or ambiguous as yet", "by the wheels and poor matches"};
  for (const TrackedScan& scan : drive.scans) {
    if (scan.pose.whereabouts == Whereabouts::kUnknown) continue;
    overlay.poses.push_back({scan.pose.T_map_base, pose_kind(scan.pose)});
  }
  MapLook look;
  look.title = "The drive of " + name_of_log(log) + " in the map";
  look.subtitle = plural(drive.scans.size(), "scan") + " with odometry, from a start that was found";
  return draw_on_map(localizer, overlay, look);
}

}  // namespace gdtslam
