// Elevation and transmission angle over the crank.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/drawing/plot.hpp"
#include "linkage_panel.hpp"

namespace gdtslam {
namespace {

constexpr Fill kLift{.colour = ink::kRocker, .opacity = 0.10};
constexpr Fill kReturn{.colour = ink::kCrank, .opacity = 0.09};
constexpr double kKeyStrength = 2.2;  ///< a small patch of a pale colour needs more of it
constexpr double kPoor_deg = 40.0;    ///< calib::kPoorTransmission_rad as people write it
constexpr double kFolded_deg = 90.0;  ///< transmission angles are at most so

/// From one crank angle on in a direction, in pieces where the axis ends between them.
void draw_stretch(Plot& plot, double from_deg, double span_deg, const Fill& fill) {
  const double low = span_deg < 0.0 ? from_deg + span_deg : from_deg;
  const double high = low + std::fabs(span_deg);
  for (const double turn : {-360.0, 0.0, 360.0}) {
    const double from = std::clamp(low + turn, 0.0, 360.0);
    const double to = std::clamp(high + turn, 0.0, 360.0);
    if (to > from) plot.stretch(from, to, fill);
  }
}

std::pair<double, double> ends_of(const std::vector<Point2>& curve) {
  std::pair ends(std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest());
  for (const Point2& place : curve) {
    if (std::isfinite(place.y())) ends = {std::min(ends.first, place.y()), std::max(ends.second, place.y())};
  }
  return ends;
}

Axis degrees_axis(std::string title, double from, double to) {
  Axis axis;
  axis.title = std::move(title);
  axis.from = from;
  axis.to = to;
  axis.steps = TickSteps::kDegrees;
  return axis;
}

}  // namespace

struct LinkagePanel::CurveOfCrank {
  const DrawingArea& card;
  std::string heading;
  const std::vector<Point2>& places;
  Axis y;
  Colour colour;
  double value_deg = 0.0;  ///< now
  std::function<void(Plot&)> below;
  std::function<void(Plot&)> above;
};

void LinkagePanel::shade_strokes(Plot& plot) const {
  if (!cycle_.report()) return;
  const double begin_deg = axis_deg(cycle_.begin().crank_rad);
  const double lift_deg = deg_from_rad(cycle_.lift_span_rad());
  draw_stretch(plot, begin_deg, lift_deg, kLift);
  draw_stretch(plot, begin_deg + lift_deg, deg_from_rad(cycle_.span_rad()) - lift_deg, kReturn);
}

void LinkagePanel::draw_curve(Canvas& canvas, const LinkageSheet& sheet, const CurveOfCrank& curve,
                              double crank_rad) const {
  const double text = sheet.text;
  const Point2 heading = curve.card.corner + Point2(1.2 * text, 1.75 * text);
  canvas.text(heading, curve.heading, {.size = 1.08 * text, .colour = theme_.text, .is_bold = true});
  const bool turns = cycle_.turns_fully();
  Axis x = degrees_axis("crank angle in degrees", turns ? 0.0 : curve.places.front().x(),
                        turns ? 360.0 : curve.places.back().x());
  x.has_grid = false;
  const DrawingArea area{curve.card.corner + Point2(0.9 * text, 2.0 * text), curve.card.width - 1.8 * text,
                         curve.card.height - 2.7 * text};
  PlotLook look;
  look.text_size = 0.95 * text;
  look.theme = theme_;
  look.has_frame = false;
  Plot plot(canvas, area, x, curve.y, look);
  curve.below(plot);
  const double at_deg = axis_deg(crank_rad);
  plot.upright(at_deg, {.colour = theme_.quiet, .width = 1.0, .opacity = 0.7});
  plot.line(curve.places, {.colour = curve.colour, .width = 0.19 * text});
  curve.above(plot);
  canvas.circle(plot.at(at_deg, curve.value_deg), 0.45 * text, Fill{.colour = curve.colour},
                Pen{.colour = theme_.card, .width = 0.14 * text});
}

void LinkagePanel::draw_elevation(Canvas& canvas, const LinkageSheet& sheet, const LinkagePosition& position) const {
  const auto [least, most] = ends_of(elevations_deg_);
  const double margin = std::max(0.05 * (most - least), 0.05);
  const Axis y = degrees_axis("", least - margin, most + margin);
  const std::string heading = "Elevation θ* in degrees";
  const auto dead_points = [&](Plot& plot) {
    for (const LinkagePosition* dead : {&cycle_.begin(), &cycle_.end()}) {
      canvas.circle(plot.at(axis_deg(dead->crank_rad), deg_from_rad(dead->elevation_rad)), 0.36 * sheet.text,
                    Fill{.colour = theme_.text}, Pen{.colour = theme_.card, .width = 0.1 * sheet.text});
    }
  };
  draw_curve(canvas, sheet,
             {.card = sheet.elevation,
              .heading = heading,
              .places = elevations_deg_,
              .y = y,
              .colour = look_.is_dark ? theme_.curve(4) : ink::kLaser,
              .value_deg = deg_from_rad(position.elevation_rad),
              .below = [this](Plot& plot) { shade_strokes(plot); },
              .above = dead_points},
             position.crank_rad);
  draw_strokes_key(canvas, sheet, sheet.elevation,
                   sheet.elevation.corner.x() + 1.2 * sheet.text + text_width(heading, 1.08 * sheet.text, true));
}

void LinkagePanel::draw_transmission(Canvas& canvas, const LinkageSheet& sheet, const LinkagePosition& position) const {
  const double text = sheet.text;
  const auto limit = [&](Plot& plot) {
    const DrawingArea& inside = plot.inside();
    const double top_y = plot.at(0.0, kPoor_deg).y();
    canvas.rectangle({inside.corner.x(), top_y}, inside.width, inside.corner.y() + inside.height - top_y,
                     Fill{.colour = theme_.warning, .opacity = 0.10});
    plot.level(kPoor_deg, {.colour = theme_.warning, .width = 1.2, .dashes = "5 4"});
  };
  const auto least = [&](Plot& plot) {
    const Point2 place = *std::min_element(transmissions_deg_.begin(), transmissions_deg_.end(),
                                           [](const Point2& a, const Point2& b) { return a.y() < b.y(); });
    canvas.circle(plot.at(place.x(), place.y()), 0.3 * text,
                  Fill{.colour = place.y() < kPoor_deg ? theme_.warning : theme_.text}, Pen{.colour = theme_.card});
  };
  draw_curve(canvas, sheet,
             {.card = sheet.transmission,
              .heading = "Transmission angle µ in degrees",
              .places = transmissions_deg_,
              .y = degrees_axis("", 0.0, kFolded_deg),
              .colour = theme_.curve(0),
              .value_deg = deg_from_rad(position.pose.transmission_rad),
              .below = limit,
              .above = least},
             position.crank_rad);
  canvas.text(sheet.transmission.corner + Point2(sheet.transmission.width - 1.4 * text, 1.75 * text), "poor below 40°",
              {.size = 0.95 * text, .colour = theme_.warning, .anchor = Anchor::kEnd});
}

void LinkagePanel::draw_strokes_key(Canvas& canvas, const LinkageSheet& sheet, const DrawingArea& card,
                                    double from_x) const {
  if (!cycle_.report()) return;
  const double text = sheet.text;
  const double size = 0.95 * text;
  const double lift_deg = std::fabs(deg_from_rad(cycle_.lift_span_rad()));
  const std::pair<std::string, Fill> keys[] = {{fmt::format("lift {:.1f}°", lift_deg), kLift},
                                               {fmt::format("return {:.1f}°", 360.0 - lift_deg), kReturn}};
  double width = 0.0;
  for (const auto& [words, fill] : keys) width += text_width(words, size) + 2.1 * text;
  Point2 at(card.corner.x() + card.width - 0.6 * text - width, card.corner.y() + 1.75 * text);
  if (at.x() < from_x + text) return;
  for (const auto& [words, fill] : keys) {
    canvas.rectangle(at + Point2(0.0, -0.8 * text), 0.9 * text, 0.9 * text,
                     Fill{.colour = fill.colour, .opacity = kKeyStrength * fill.opacity}, std::nullopt, 2.0);
    canvas.text(at + Point2(1.3 * text, 0.0), words, {.size = size, .colour = theme_.quiet});
    at.x() += text_width(words, size) + 2.1 * text;
  }
}

}  // namespace gdtslam
