#include "linkage_drawing.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/drawing/plots/bars.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using calib::LinkageCycle;
using calib::LinkagePosition;
using calib::unit_at;

constexpr int kLiftSteps = 240;
constexpr int kFaintPositions = 6;
constexpr double kBeam = 1.42;  ///< length of the laser's plane from the rocker's pivot, in rockers

/// Joints on the page: crank's pivot, crank's end, coupler's end, rocker's pivot.
using Joints = std::array<Point2, 4>;

/// The linkage's plane on the page.
class Stage {
 public:
  Stage(const LinkageCycle& cycle, const DrawingArea& area) : rocker_m_(cycle.model().bars.rocker_m) {
    Eigen::AlignedBox2d covered(Point2::Zero());
    for (const LinkagePosition& position : cycle.positions()) {
      for (const Point2& joint : position.joints) covered.extend(joint);
      covered.extend(kBeam * rocker_m_ * unit_at(position.elevation_rad));
    }
    const Point2 size = covered.sizes();
    pixels_per_m = std::min(area.width / size.x(), area.height / size.y());
    const Point2 middle = covered.center();
    pivot_ = area.corner + 0.5 * Point2(area.width, area.height) - pixels_per_m * Point2(middle.x(), -middle.y());
  }

  [[nodiscard]] Point2 at(const Point2& place_m) const {
    return pivot_ + pixels_per_m * Point2(place_m.x(), -place_m.y());
  }
  [[nodiscard]] Joints joints(const LinkagePosition& position) const {
    return {at(position.joints[0]), at(position.joints[1]), at(position.joints[2]), pivot_};
  }
  /// The laser's plane beyond the rocker.
  [[nodiscard]] Point2 beam(double elevation_rad) const { return at(kBeam * rocker_m_ * unit_at(elevation_rad)); }

  double pixels_per_m = 1.0;

 private:
  double rocker_m_;
  Point2 pivot_ = Point2::Zero();
};

void draw_bars(Canvas& canvas, const Joints& joints, double width, double opacity) {
  canvas.line(joints[3], joints[2], {.colour = ink::kRocker, .width = width, .opacity = opacity});
  canvas.line(joints[1], joints[2], {.colour = ink::kCoupler, .width = width, .opacity = opacity});
  canvas.line(joints[0], joints[1], {.colour = ink::kCrank, .width = width, .opacity = opacity});
}

void draw_laser(Canvas& canvas, const LinkageCycle& cycle, const Stage& stage) {
  std::vector<Point2> sector = {stage.at(Point2::Zero())};
  for (const LinkagePosition& position : cycle.stretch(cycle.lift_span_rad(), kLiftSteps)) {
    sector.push_back(stage.beam(position.elevation_rad));
  }
  canvas.polygon(sector, Fill{ink::kLaser, 0.10});
  for (const LinkagePosition* end : {&cycle.begin(), &cycle.end()}) {
    canvas.line(sector.front(), stage.beam(end->elevation_rad), {.colour = ink::kLaser, .width = 1.5, .dashes = "7 5"});
  }
}

void draw_paths(Canvas& canvas, const LinkageCycle& cycle, const Stage& stage) {
  std::vector<Point2> circle;
  std::vector<Point2> arc;
  std::vector<Point2> curve;
  for (const LinkagePosition& position : cycle.positions()) {
    circle.push_back(stage.at(position.joints[1]));
    arc.push_back(stage.at(position.joints[2]));
    curve.push_back(stage.at(position.middle));
  }
  canvas.polyline(circle, {.colour = ink::kCrank, .width = 1.5, .opacity = 0.6, .dashes = "2 5"});
  canvas.polyline(arc, {.colour = ink::kRocker, .width = 2.0, .opacity = 0.6, .dashes = "2 5"});
  canvas.polyline(curve, {.colour = ink::kCurve, .width = 2.0});
}

/// Hatched feet under a fixed pivot.
void draw_pivot(Canvas& canvas, const Point2& at) {
  canvas.polygon({at, at + Point2(-12.0, 20.0), at + Point2(12.0, 20.0)}, Fill{ink::kGround, 0.9});
  for (int i = 0; i < 4; ++i) {
    const Point2 foot = at + Point2(-12.0 + 8.0 * i, 20.0);
    canvas.line(foot, foot + Point2(-5.0, 7.0), {.colour = ink::kGround, .width = 1.2});
  }
  canvas.circle(at, 6.5, Fill{ink::kCard}, Pen{.colour = ink::kGround, .width = 2.5});
}

void draw_legend(Canvas& canvas, const Point2& corner, double text) {
  struct Item {
    Pen pen;
    std::string_view words;
  };
  const Item items[] = {{{.colour = ink::kCurve, .width = 2.0}, "path of the coupler's middle"},
                        {{.colour = ink::kLaser, .width = 1.5, .dashes = "7 5"}, "laser's plane"},
                        {{.colour = ink::kRocker, .width = 2.5, .opacity = 0.3}, "even steps of the crank"}};
  Point2 at = corner;
  for (const Item& item : items) {
    canvas.line(at, at + Point2(2.0 * text, 0.0), item.pen);
    canvas.text(at + text * Point2(2.6, 0.34), item.words, {.size = text, .colour = ink::kQuiet});
    at.x() += 4.2 * text + text_width(item.words, text);
  }
}

void draw_schematic(Canvas& canvas, const LinkageCycle& cycle, const LinkagePanel& panel, const LinkageSheet& sheet,
                    const LinkagePosition& shown) {
  const DrawingArea& scene = sheet.scene;
  const double text = sheet.text;
  const Stage stage(cycle,
                    {scene.corner + text * Point2(5.0, 5.0), scene.width - 10.0 * text, scene.height - 11.0 * text});
  draw_laser(canvas, cycle, stage);
  draw_paths(canvas, cycle, stage);
  for (const LinkagePosition& position : cycle.stretch(cycle.lift_span_rad(), kFaintPositions)) {
    draw_bars(canvas, stage.joints(position), 2.5, 0.22);
  }
  for (const LinkagePosition* end : {&cycle.begin(), &cycle.end()}) {
    const Joints joints = stage.joints(*end);
    draw_bars(canvas, joints, 2.5, 0.55);
    canvas.circle(joints[2], 6.0, Fill{ink::kText}, Pen{.colour = ink::kCard, .width = 2.0});
  }
  const Joints joints = stage.joints(shown);
  canvas.line(joints[0], joints[3], {.colour = ink::kGround, .width = 3.0, .dashes = "1 7"});
  draw_bars(canvas, joints, 8.0, 1.0);
  for (const Point2& joint : {joints[1], joints[2]}) {
    canvas.circle(joint, 6.0, Fill{ink::kCard}, Pen{.colour = ink::kText, .width = 2.0});
  }
  draw_pivot(canvas, joints[0]);
  draw_pivot(canvas, joints[3]);
  for (const LinkagePosition* end : {&cycle.begin(), &cycle.end()}) {
    panel.draw_sweep_label(canvas, sheet, stage.beam(end->elevation_rad), joints[3], end->elevation_rad);
  }
  draw_legend(canvas, scene.corner + Point2(1.4 * text, scene.height - 1.2 * text), text);
  draw_scale_bar(canvas, {.pixels_per_m = stage.pixels_per_m, .most = 130.0, .text_size = text},
                 scene.corner + text * Point2(1.4, 2.2));
}

}  // namespace

Canvas linkage_drawing(const LinkageCycle& cycle) {
  constexpr double kWidth = 1280.0;
  constexpr double kHeight = 800.0;
  const LinkageSheet sheet = linkage_sheet(kWidth, kHeight, true);
  const LinkagePanel panel(cycle, false, false);
  const LinkagePosition shown = cycle.at(cycle.shown_crank_rad()).value_or(cycle.begin());
  Canvas canvas(kWidth, kHeight, "Linkage " + cycle.model().name);
  panel.draw_ground(canvas, sheet);
  draw_schematic(canvas, cycle, panel, sheet, shown);
  panel.draw_readings(canvas, sheet, shown);
  return canvas;
}

}  // namespace gdtslam
