// The linkage itself in several positions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "linkage_drawing_parts.hpp"

namespace gdtslam {
namespace {

constexpr int kLiftSteps = 240;
constexpr int kTurnSteps = 360;
constexpr int kFaintPositions = 6;
/// Length of the laser's plane from the rocker's pivot, in rockers.
constexpr double kBeam = 1.42;
constexpr double kEighthTurn = 0.25 * kPi;

/// The joints of one position, in pixels.
struct Joints {
  Point2 crank_pivot;
  Point2 crank_end;
  Point2 rocker_end;
  Point2 rocker_pivot;
};

/// The linkage's plane as the drawing has it: turned so that the rocker's direction is the elevation.
class Stage {
 public:
  Stage(const LinkageSummary& summary, const Box& box) : summary_(summary) { fit(box); }

  [[nodiscard]] Point2 at(const Point2& place_m) const { return shift_ + scale_ * turned(place_m); }
  [[nodiscard]] double pixels_per_m() const { return scale_; }

  [[nodiscard]] Joints joints(const LinkageRow& row) const {
    const calib::FourBar& bars = summary_.model.bars;
    const Point2 crank_end = bars.crank_m * direction(row.crank_rad);
    const Point2 pivot(bars.ground_m, 0.0);
    return {.crank_pivot = at(Point2::Zero()),
            .crank_end = at(crank_end),
            .rocker_end = at(pivot + bars.rocker_m * direction(row.pose.rocker_rad)),
            .rocker_pivot = at(pivot)};
  }

  /// On the laser's plane, `share` rockers from the pivot.
  [[nodiscard]] Point2 beam(const LinkageRow& row, double share) const {
    const calib::FourBar& bars = summary_.model.bars;
    return at(Point2(bars.ground_m, 0.0) + share * bars.rocker_m * direction(row.pose.rocker_rad));
  }

  static Point2 direction(double angle_rad) {
    const SinCos<double> unit = sin_cos(angle_rad);
    return {unit.cos, unit.sin};
  }

 private:
  [[nodiscard]] Point2 turned(const Point2& place) const {
    const SinCos<double> by = sin_cos(summary_.model.elevation_offset_rad);
    const double y = summary_.model.elevation_sign * place.y();
    return {by.cos * place.x() - by.sin * y, -(by.sin * place.x() + by.cos * y)};  // pixels grow downward
  }

  void fit(const Box& box) {
    Point2 low(1e9, 1e9);
    Point2 high(-1e9, -1e9);
    const auto include = [&](const Point2& place) {
      low = low.cwiseMin(turned(place));
      high = high.cwiseMax(turned(place));
    };
    const calib::FourBar& bars = summary_.model.bars;
    for (int i = 0; i < 8; ++i) {
      include(1.25 * bars.crank_m * direction(kEighthTurn * i));
    }
    include({bars.ground_m, 0.0});
    for (const LinkageRow& row : rows_of(summary_, kTurnSteps)) {
      include(Point2(bars.ground_m, 0.0) + kBeam * bars.rocker_m * direction(row.pose.rocker_rad));
    }
    const Point2 size = high - low;
    scale_ = std::min(box.width / size.x(), box.height / size.y());
    shift_ = box.corner + 0.5 * Point2(box.width, box.height) - 0.5 * scale_ * (low + high);
  }

  const LinkageSummary& summary_;
  double scale_ = 1.0;
  Point2 shift_ = Point2::Zero();
};

std::vector<LinkageRow> lift_rows(const LinkageSummary& summary, int steps) {
  LinkageSummary lift = summary;
  lift.span_rad = lift_span_rad(summary);
  return rows_of(lift, steps);
}

void draw_bars(Canvas& canvas, const Joints& joints, double width, double opacity) {
  canvas.line(joints.rocker_pivot, joints.rocker_end, {.colour = ink::kRocker, .width = width, .opacity = opacity});
  canvas.line(joints.crank_end, joints.rocker_end, {.colour = ink::kCoupler, .width = width, .opacity = opacity});
  canvas.line(joints.crank_pivot, joints.crank_end, {.colour = ink::kCrank, .width = width, .opacity = opacity});
}

void draw_laser(Canvas& canvas, const LinkageSummary& summary, const Stage& stage) {
  const std::vector<LinkageRow> rows = lift_rows(summary, kLiftSteps);
  if (rows.empty()) {
    return;
  }
  const Point2 pivot = stage.at({summary.model.bars.ground_m, 0.0});
  std::vector<Point2> sector = {pivot};
  for (const LinkageRow& row : rows) {
    sector.push_back(stage.beam(row, kBeam));
  }
  canvas.polygon(sector, Fill{ink::kLaser, 0.10});
  for (const LinkageRow* row : {&rows.front(), &rows.back()}) {
    canvas.line(pivot, stage.beam(*row, kBeam), {.colour = ink::kLaser, .width = 1.5, .dashes = "7 5"});
  }
}

/// Where the laser looks at both ends of the lift, beyond the sweep's rim.
void draw_elevation_label(Canvas& canvas, const Stage& stage, const LinkageRow& row) {
  constexpr double kGap = 14.0;
  const Point2 tip = stage.beam(row, kBeam);
  const Point2 away = tip - stage.beam(row, 0.0);
  const Point2 outward = away / std::sqrt(away.x() * away.x() + away.y() * away.y());
  const bool is_side = std::fabs(outward.x()) > 0.5;
  const double drop = is_side ? 5.0 : (outward.y() > 0.0 ? 12.0 : 0.0);
  canvas.text(tip + kGap * outward + Point2(0.0, drop), degrees_text(row.elevation_rad) + "°",
              {.size = 14.0,
               .colour = ink::kLaserText,
               .anchor = !is_side ? Anchor::kMiddle : (outward.x() > 0.0 ? Anchor::kStart : Anchor::kEnd),
               .is_bold = true,
               .has_halo = true});
}

void draw_paths(Canvas& canvas, const LinkageSummary& summary, const Stage& stage) {
  const calib::FourBar& bars = summary.model.bars;
  std::vector<Point2> arc;
  std::vector<Point2> curve;
  for (const LinkageRow& row : rows_of(summary, kTurnSteps)) {
    arc.push_back(stage.joints(row).rocker_end);
    const auto middle = calib::coupler_point(bars, summary.model.assembly, row.crank_rad, 0.5 * bars.coupler_m, 0.0);
    curve.push_back(stage.at(middle.value_or(Point2::Zero())));
  }
  canvas.circle(stage.at(Point2::Zero()), bars.crank_m * stage.pixels_per_m(), std::nullopt,
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

/// A bar's name and length beside its middle, away from the loop.
void draw_label(Canvas& canvas, const Point2& from, const Point2& to, const Point2& centre, Colour colour,
                const std::string& words) {
  const Point2 along = to - from;
  const double length = std::sqrt(along.x() * along.x() + along.y() * along.y());
  Point2 normal(-along.y() / length, along.x() / length);
  const Point2 middle = 0.5 * (from + to);
  const Point2 outward = middle - centre;
  if (normal.x() * outward.x() + normal.y() * outward.y() < 0.0) {
    normal = -normal;
  }
  // The text's box, kept clear of the line through the bar.
  constexpr double kLetterWidth = 8.2;
  constexpr double kHalfHeight = 7.0;
  constexpr double kClearance = 7.0;
  const double half_width = 0.5 * kLetterWidth * static_cast<double>(words.size());
  const double away = half_width * std::fabs(normal.x()) + kHalfHeight * std::fabs(normal.y()) + kClearance;
  canvas.text(middle + away * normal + Point2(0.0, 5.0), words,
              {.size = 14.0, .colour = colour, .anchor = Anchor::kMiddle, .is_bold = true, .has_halo = true});
}

void draw_labels(Canvas& canvas, const calib::FourBar& bars, const Joints& joints) {
  const Point2 centre = 0.25 * (joints.crank_pivot + joints.crank_end + joints.rocker_end + joints.rocker_pivot);
  const auto words = [](const char* name, double length_m) {
    return fmt::format("{} {:.5g} cm", name, 100.0 * length_m);
  };
  draw_label(canvas, joints.crank_pivot, joints.crank_end, centre, ink::kCrank, words("crank", bars.crank_m));
  draw_label(canvas, joints.crank_end, joints.rocker_end, centre, ink::kCoupler, words("coupler", bars.coupler_m));
  draw_label(canvas, joints.rocker_end, joints.rocker_pivot, centre, ink::kRocker, words("rocker", bars.rocker_m));
  draw_label(canvas, joints.crank_pivot, joints.rocker_pivot, centre, ink::kGround, words("ground", bars.ground_m));
}

/// Which way the crank turns so that lifting is the slow stroke.
void draw_turning(Canvas& canvas, const LinkageSummary& summary, const Stage& stage, double crank_rad) {
  constexpr double kArc_rad = 0.8;
  constexpr double kAhead_rad = 1.15;  // clear of the crank's label
  constexpr int kArcSteps = 24;
  constexpr double kArcRadius = 1.16;
  const double radius_m = kArcRadius * summary.model.bars.crank_m;
  const double from_rad = crank_rad + summary.lift_direction * kAhead_rad;
  std::vector<Point2> arc;
  for (int i = 0; i <= kArcSteps; ++i) {
    arc.push_back(stage.at(radius_m * Stage::direction(from_rad + summary.lift_direction * kArc_rad * i / kArcSteps)));
  }
  canvas.polyline(arc, {.colour = ink::kCrank, .width = 2.0});
  const Point2 tip = arc.back();
  const Point2 back = arc[arc.size() - 4] - tip;
  const double length = std::sqrt(back.x() * back.x() + back.y() * back.y());
  const Point2 along = 11.0 / length * back;
  const Point2 across(-0.5 * along.y(), 0.5 * along.x());
  canvas.polygon({tip - 0.4 * along, tip + along + across, tip + along - across}, Fill{ink::kCrank, 1.0});
}

void draw_dead_points(Canvas& canvas, const Stage& stage, const std::vector<LinkageRow>& lift) {
  for (const LinkageRow* row : {&lift.front(), &lift.back()}) {
    const Joints joints = stage.joints(*row);
    draw_bars(canvas, joints, 2.5, 0.55);
    canvas.circle(joints.rocker_end, 6.0, Fill{ink::kText}, Pen{.colour = ink::kCard, .width = 2.0});
    canvas.circle(joints.crank_end, 4.0, Fill{ink::kText}, Pen{.colour = ink::kCard, .width = 1.5});
  }
}

void draw_scale(Canvas& canvas, const Stage& stage, const Point2& right_end) {
  double bar_cm = 0.1;
  for (const double length_cm : {0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0}) {
    bar_cm = 0.01 * length_cm * stage.pixels_per_m() <= 130.0 ? length_cm : bar_cm;
  }
  const Point2 left_end = right_end - Point2(0.01 * bar_cm * stage.pixels_per_m(), 0.0);
  canvas.line(left_end, right_end, {.colour = ink::kText, .width = 2.0});
  for (const Point2& end : {left_end, right_end}) {
    canvas.line(end + Point2(0.0, -4.0), end + Point2(0.0, 4.0), {.colour = ink::kText, .width = 2.0});
  }
  canvas.text(0.5 * (left_end + right_end) + Point2(0.0, -9.0), fmt::format("{:g} cm", bar_cm),
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

}  // namespace

double lift_span_rad(const LinkageSummary& summary) {
  return summary.report ? summary.lift_direction * kTwoPi * summary.report->lift_share : summary.span_rad;
}

double shown_crank_rad(const LinkageSummary& summary) {
  const std::vector<LinkageRow> rows = lift_rows(summary, kLiftSteps);
  const auto first = rows.begin() + static_cast<std::ptrdiff_t>(rows.size() / 5);
  const auto last = rows.end() - static_cast<std::ptrdiff_t>(rows.size() / 5);
  const auto best = std::max_element(first, last, [](const LinkageRow& a, const LinkageRow& b) {
    return a.pose.transmission_rad < b.pose.transmission_rad;
  });
  return best == last ? summary.from_rad : best->crank_rad;
}

void draw_positions(Canvas& canvas, const LinkageSummary& summary, double shown_rad, const Box& box) {
  constexpr double kLegendHeight = 74.0;
  const Box inner{box.corner + Point2(86.0, 72.0), box.width - 172.0, box.height - 72.0 - kLegendHeight - 44.0};
  const Stage stage(summary, inner);
  const std::vector<LinkageRow> lift = lift_rows(summary, kFaintPositions);
  const std::optional<LinkageRow> shown = row_at(summary.model, shown_rad);
  draw_laser(canvas, summary, stage);
  draw_paths(canvas, summary, stage);
  for (const LinkageRow& row : lift) {
    draw_bars(canvas, stage.joints(row), 2.5, 0.22);
  }
  if (!lift.empty()) {
    draw_dead_points(canvas, stage, lift);
  }
  if (shown) {
    const Joints joints = stage.joints(*shown);
    canvas.line(joints.crank_pivot, joints.rocker_pivot, {.colour = ink::kGround, .width = 3.0, .dashes = "1 7"});
    draw_bars(canvas, joints, 8.0, 1.0);
    for (const Point2& joint : {joints.crank_end, joints.rocker_end}) {
      canvas.circle(joint, 6.0, Fill{ink::kCard}, Pen{.colour = ink::kText, .width = 2.0});
    }
    if (summary.report) {
      draw_turning(canvas, summary, stage, shown_rad);
    }
    draw_pivot(canvas, joints.crank_pivot);
    draw_pivot(canvas, joints.rocker_pivot);
    draw_labels(canvas, summary.model.bars, joints);
  }
  if (!lift.empty()) {
    draw_elevation_label(canvas, stage, lift.front());
    draw_elevation_label(canvas, stage, lift.back());
  }
  const Point2 foot = box.corner + Point2(24.0, box.height - kLegendHeight);
  canvas.line(foot + Point2(-4.0, -6.0), foot + Point2(box.width - 44.0, -6.0), {.colour = ink::kGrid});
  draw_legend(canvas, foot + Point2(0.0, 22.0), summary.report.has_value());
  draw_scale(canvas, stage, box.corner + Point2(box.width - 24.0, 40.0));
}

}  // namespace gdtslam
