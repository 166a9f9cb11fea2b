#include "linkage_drawing.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/drawing/ticks.hpp"

namespace gdtslam {
namespace {

using calib::LinkageCycle;
using calib::LinkagePosition;
using calib::unit_at;

constexpr double kSchematicWidth = 1280.0;
constexpr double kHeight = 800.0;
constexpr double kText = 14.0;
constexpr double kLegendHeight = 74.0;
constexpr int kLiftSteps = 240;
constexpr int kFaintPositions = 6;
/// Length of the laser's plane from the rocker's pivot, in rockers.
constexpr double kBeam = 1.42;
constexpr double kEighthTurn = 0.25 * kPi;

/// Of the page: crank's pivot, crank's end, coupler's end, rocker's pivot.
using Joints = std::array<Point2, 4>;

Point2 unit_vector(const Point2& v) { return v / std::sqrt(v.x() * v.x() + v.y() * v.y()); }

/// The linkage's plane on the page.
class Stage {
 public:
  Stage(const LinkageCycle& cycle, const DrawingArea& area) : cycle_(cycle) {
    const calib::FourBar& bars = cycle.model().bars;
    const Point2 crank_pivot = cycle.positions().front().joints[0];
    Eigen::AlignedBox2d covered(Point2::Zero());
    for (int i = 0; i < 8; ++i) {
      covered.extend(crank_pivot + 1.25 * bars.crank_m * unit_at(kEighthTurn * i + cycle.model().elevation_offset_rad));
    }
    for (const LinkagePosition& position : cycle.positions()) {
      covered.extend(kBeam * bars.rocker_m * unit_at(position.elevation_rad));
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
  /// On the laser's plane, `share` rockers from the pivot.
  [[nodiscard]] Point2 beam(const LinkagePosition& position, double share = kBeam) const {
    return at(share * cycle_.model().bars.rocker_m * unit_at(position.elevation_rad));
  }

  double pixels_per_m = 1.0;

 private:
  const LinkageCycle& cycle_;
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
    sector.push_back(stage.beam(position));
  }
  canvas.polygon(sector, Fill{ink::kLaser, 0.10});
  for (const LinkagePosition& end : {cycle.begin(), cycle.end()}) {
    canvas.line(sector.front(), stage.beam(end), {.colour = ink::kLaser, .width = 1.5, .dashes = "7 5"});
  }
}

void draw_paths(Canvas& canvas, const LinkageCycle& cycle, const Stage& stage) {
  std::vector<Point2> arc;
  std::vector<Point2> curve;
  // Half of them are enough for a smooth curve.
  for (std::size_t i = 0; i < cycle.positions().size(); i += 2) {
    arc.push_back(stage.at(cycle.positions()[i].joints[2]));
    curve.push_back(stage.at(cycle.positions()[i].middle));
  }
  canvas.circle(stage.at(cycle.begin().joints[0]), cycle.model().bars.crank_m * stage.pixels_per_m, std::nullopt,
                Pen{.colour = ink::kCrank, .width = 1.5, .opacity = 0.6, .dashes = "2 5"});
  canvas.polyline(arc, {.colour = ink::kRocker, .width = 2.0, .opacity = 0.6, .dashes = "2 5"});
  canvas.polyline(curve, {.colour = ink::kCurve, .width = 2.0});
}

/// Hatched feet under a pivot that is fixed to the robot.
void draw_pivot(Canvas& canvas, const Point2& at) {
  canvas.polygon({at, at + Point2(-12.0, 20.0), at + Point2(12.0, 20.0)}, Fill{ink::kGround, 0.9});
  for (int i = 0; i < 4; ++i) {
    const Point2 foot = at + Point2(-12.0 + 8.0 * i, 20.0);
    canvas.line(foot, foot + Point2(-5.0, 7.0), {.colour = ink::kGround, .width = 1.2});
  }
  canvas.circle(at, 6.5, Fill{ink::kCard}, Pen{.colour = ink::kGround, .width = 2.5});
}

/// Each bar's name and length beside its middle, away from the loop.
void draw_labels(Canvas& canvas, const calib::FourBar& bars, const Joints& joints) {
  struct Bar {
    const Point2& from;
    const Point2& to;
    Colour colour;
    const char* name;
    double length_m;
  };
  const Bar all[] = {{joints[0], joints[1], ink::kCrank, "crank", bars.crank_m},
                     {joints[1], joints[2], ink::kCoupler, "coupler", bars.coupler_m},
                     {joints[2], joints[3], ink::kRocker, "rocker", bars.rocker_m},
                     {joints[0], joints[3], ink::kGround, "ground", bars.ground_m}};
  const Point2 centre = 0.25 * (joints[0] + joints[1] + joints[2] + joints[3]);
  for (const Bar& bar : all) {
    const Point2 along = unit_vector(bar.to - bar.from);
    Point2 normal(-along.y(), along.x());
    const Point2 middle = 0.5 * (bar.from + bar.to);
    if (normal.dot(middle - centre) < 0.0) normal = -normal;
    // The text's box, kept clear of the line through the bar.
    constexpr double kLetterWidth = 8.2;
    constexpr double kHalfHeight = 7.0;
    constexpr double kClearance = 7.0;
    const std::string words = fmt::format("{} {:.5g} cm", bar.name, 100.0 * bar.length_m);
    const double half_width = 0.5 * kLetterWidth * static_cast<double>(words.size());
    const double away = half_width * std::fabs(normal.x()) + kHalfHeight * std::fabs(normal.y()) + kClearance;
    canvas.text(middle + away * normal + Point2(0.0, 5.0), words,
                {.size = kText, .colour = bar.colour, .anchor = Anchor::kMiddle, .is_bold = true, .has_halo = true});
  }
}

/// Which way the crank turns so that lifting is the slow stroke.
void draw_turning(Canvas& canvas, const LinkageCycle& cycle, const Stage& stage, double crank_rad) {
  constexpr double kArc_rad = 0.8;
  constexpr double kAhead_rad = 1.15;  // clear of the crank's label
  constexpr int kArcSteps = 24;
  constexpr double kArcRadius = 1.16;
  const double radius_m = kArcRadius * cycle.model().bars.crank_m;
  const double side = cycle.span_rad() > 0.0 ? 1.0 : -1.0;
  std::vector<Point2> arc;
  for (int i = 0; i <= kArcSteps; ++i) {
    const double angle_rad = crank_rad + side * (kAhead_rad + kArc_rad * i / kArcSteps);
    arc.push_back(stage.at(calib::place_in_mount(cycle.model(), radius_m * unit_at(angle_rad))));
  }
  canvas.polyline(arc, {.colour = ink::kCrank, .width = 2.0});
  const Point2 tip = arc.back();
  const Point2 along = 11.0 * unit_vector(arc[arc.size() - 4] - tip);
  const Point2 across(-0.5 * along.y(), 0.5 * along.x());
  canvas.polygon({tip - 0.4 * along, tip + along + across, tip + along - across}, Fill{ink::kCrank, 1.0});
}

/// In full, with all names.
void draw_shown(Canvas& canvas, const LinkageCycle& cycle, const Stage& stage, const LinkagePosition& position) {
  const Joints joints = stage.joints(position);
  canvas.line(joints[0], joints[3], {.colour = ink::kGround, .width = 3.0, .dashes = "1 7"});
  draw_bars(canvas, joints, 8.0, 1.0);
  for (const Point2& joint : {joints[1], joints[2]}) {
    canvas.circle(joint, 6.0, Fill{ink::kCard}, Pen{.colour = ink::kText, .width = 2.0});
  }
  if (cycle.report()) draw_turning(canvas, cycle, stage, position.crank_rad);
  draw_pivot(canvas, joints[0]);
  draw_pivot(canvas, joints[3]);
  draw_labels(canvas, cycle.model().bars, joints);
}

void draw_scale(Canvas& canvas, const Stage& stage, const Point2& right_end) {
  const double length_m = round_length_m(130.0 / stage.pixels_per_m);
  const Point2 left_end = right_end - Point2(length_m * stage.pixels_per_m, 0.0);
  canvas.line(left_end, right_end, {.colour = ink::kText, .width = 2.0});
  for (const Point2& end : {left_end, right_end}) {
    canvas.line(end + Point2(0.0, -4.0), end + Point2(0.0, 4.0), {.colour = ink::kText, .width = 2.0});
  }
  canvas.text(0.5 * (left_end + right_end) + Point2(0.0, -9.0), length_text(length_m),
              {.size = 12.0, .anchor = Anchor::kMiddle});
}

void draw_legend(Canvas& canvas, const Point2& corner, bool lifts) {
  struct Item {
    Pen pen;
    std::string_view words;
    double x;
    double y;
  };
  const Item items[] = {
      {{.colour = ink::kCoupler, .width = 7.0}, "position with labels", 0.0, 0.0},
      {{.colour = ink::kCoupler, .width = 2.5, .opacity = 0.3},
       lifts ? "even steps of the crank" : "other positions",
       0.0,
       24.0},
      {{.colour = ink::kRocker, .width = 2.0, .opacity = 0.8, .dashes = "2 5"}, "paths of the joints", 222.0, 0.0},
      {{.colour = ink::kCurve, .width = 2.0}, "path of the coupler's middle", 222.0, 24.0},
      {{.colour = ink::kLaser, .width = 1.5, .dashes = "7 5"}, "laser's plane, its sweep", 458.0, 0.0}};
  for (const Item& item : items) {
    const Point2 at = corner + Point2(item.x, item.y);
    canvas.line(at, at + Point2(28.0, 0.0), item.pen);
    canvas.text(at + Point2(40.0, 4.0), item.words, {.size = 13.0});
  }
  const Point2 dot = corner + Point2(458.0, 24.0);
  canvas.circle(dot + Point2(14.0, 0.0), 6.0, Fill{ink::kText}, Pen{.colour = ink::kCard, .width = 2.0});
  canvas.text(dot + Point2(40.0, 4.0), lifts ? "dead points of the rocker" : "ends of the stretch", {.size = 13.0});
}

void draw_positions(Canvas& canvas, const LinkageCycle& cycle, const LinkagePanel& panel, const LinkageSheet& sheet,
                    const LinkagePosition& shown) {
  const DrawingArea& card = sheet.card;
  const Stage stage(cycle, {card.corner + Point2(86.0, 72.0), card.width - 172.0, card.height - 116.0 - kLegendHeight});
  draw_laser(canvas, cycle, stage);
  draw_paths(canvas, cycle, stage);
  for (const LinkagePosition& position : cycle.stretch(cycle.lift_span_rad(), kFaintPositions)) {
    draw_bars(canvas, stage.joints(position), 2.5, 0.22);
  }
  for (const LinkagePosition& end : {cycle.begin(), cycle.end()}) {
    const Joints joints = stage.joints(end);
    draw_bars(canvas, joints, 2.5, 0.55);
    canvas.circle(joints[2], 6.0, Fill{ink::kText}, Pen{.colour = ink::kCard, .width = 2.0});
    canvas.circle(joints[1], 4.0, Fill{ink::kText}, Pen{.colour = ink::kCard, .width = 1.5});
  }
  draw_shown(canvas, cycle, stage, shown);
  for (const LinkagePosition& end : {cycle.begin(), cycle.end()}) {
    panel.draw_sweep_label(canvas, sheet, stage.beam(end), stage.at(Point2::Zero()), end.elevation_rad);
  }
  const Point2 foot = card.corner + Point2(24.0, card.height - kLegendHeight);
  canvas.line(foot + Point2(-4.0, -6.0), foot + Point2(card.width - 44.0, -6.0), {.colour = ink::kGrid});
  draw_legend(canvas, foot + Point2(0.0, 22.0), cycle.report().has_value());
  draw_scale(canvas, stage, card.corner + Point2(card.width - 24.0, 40.0));
}

struct KeyFigure {
  std::string value;
  std::string meaning;
  Colour colour = ink::kText;
};

std::vector<KeyFigure> key_figures(const LinkageCycle& cycle) {
  const auto degrees = [](double angle_deg) { return fmt::format("{:.1f}°", angle_deg); };
  const calib::FreudensteinCoefficients k = calib::freudenstein(cycle.model().bars);
  const KeyFigure coefficients{fmt::format("{:.3f}  {:.3f}  {:.3f}", k.k1, k.k2, k.k3), "Freudenstein K1, K2, K3"};
  if (!cycle.report()) return {{degrees(deg_from_rad(cycle.span_rad())), "of the crank's turn"}, coefficients};
  const calib::CrankRockerReport& report = *cycle.report();
  const bool is_poor = report.least_transmission_rad < calib::kPoorTransmission_rad;
  return {{degrees(deg_from_rad(report.swing_rad)), "swing of the laser"},
          {degrees(360.0 * report.lift_share), "of the turn lift"},
          {fmt::format("{:.2f}", report.time_ratio), "lift over return"},
          {degrees(deg_from_rad(report.least_transmission_rad)), "least transmission",
           is_poor ? ink::kWarning : ink::kText},
          {fmt::format("{:.2f}", report.most_rocker_rate), "most rocker per crank"},
          coefficients};
}

void draw_figures(Canvas& canvas, const LinkageCycle& cycle, const DrawingArea& card) {
  constexpr double kColumns[] = {20.0, 168.0, 316.0};
  const std::vector<KeyFigure> figures = key_figures(cycle);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const std::size_t row = i / 3;
    const Point2 at = card.corner + Point2(kColumns[i % 3], 66.0 + 58.0 * static_cast<double>(row));
    const bool is_long = figures[i].value.size() > 12;
    canvas.text(at, figures[i].value, {.size = is_long ? 14.0 : 22.0, .colour = figures[i].colour, .is_bold = true});
    canvas.text(at + Point2(0.0, 19.0), figures[i].meaning, {.size = 12.0, .colour = ink::kQuiet});
  }
}

}  // namespace

Canvas linkage_drawing(const LinkageCycle& cycle) {
  const DrawingArea card{{40.0, 104.0}, 700.0, 656.0};
  const LinkageSheet sheet{.text = kText,
                           .header = {{40.0, 31.0}, 1200.0, 60.0},
                           .card = card,
                           .scene = card,
                           .figures = {{760.0, 600.0}, 480.0, 160.0},
                           .elevation = {{760.0, 104.0}, 480.0, 252.0},
                           .transmission = {{760.0, 372.0}, 480.0, 212.0}};
  const LinkagePanel panel(cycle, {.is_still = true});
  const LinkagePosition shown = cycle.at(cycle.shown_crank_rad()).value_or(cycle.begin());
  Canvas canvas(kSchematicWidth, kHeight, "Linkage " + cycle.model().name);
  panel.draw_ground(canvas, sheet);
  panel.draw_heading(canvas, sheet, card,
                     cycle.report() ? "Positions over the lift, the crank turning evenly" : "Positions");
  panel.draw_heading(canvas, sheet, sheet.figures, "In figures");
  draw_positions(canvas, cycle, panel, sheet, shown);
  panel.draw_plots(canvas, sheet, shown);
  draw_figures(canvas, cycle, sheet.figures);
  return canvas;
}

}  // namespace gdtslam
