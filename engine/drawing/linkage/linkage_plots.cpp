// Elevation and transmission angle over the crank.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/drawing/plot.hpp"
#include "linkage_drawing.hpp"

namespace gdtslam {
namespace {

constexpr Fill kLift{.colour = ink::kRocker, .opacity = 0.10};
constexpr Fill kReturn{.colour = ink::kCrank, .opacity = 0.09};
constexpr double kKeyStrength = 2.2;  ///< a small patch of a pale colour needs more of it
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

std::pair<double, double> least_and_most(const std::vector<Point2>& curve) {
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

void LinkagePanel::draw_plots(Canvas& canvas, const LinkageSheet& sheet, const calib::LinkagePosition& position) const {
  draw_elevation(canvas, sheet, position);
  if (sheet.transmission.width > 0.0) draw_transmission(canvas, sheet, position);
}

void LinkagePanel::shade_strokes(Plot& plot) const {
  if (!cycle_.report()) return;
  const double begin_deg = axis_deg(cycle_.begin().crank_rad);
  const double turn_deg = deg_from_rad(look_.is_still ? std::fabs(cycle_.span_rad()) : cycle_.span_rad());
  const double lift_deg = turn_deg * cycle_.report()->lift_share;
  draw_stretch(plot, begin_deg, lift_deg, kLift);
  draw_stretch(plot, begin_deg + lift_deg, turn_deg - lift_deg, kReturn);
}

Plot LinkagePanel::plot_on(Canvas& canvas, const LinkageSheet& sheet, const DrawingArea& card, const Axis& y) const {
  const double text = sheet.text;
  const bool turns = cycle_.turns_fully();
  const char* title = "Crank angle (°)";
  if (look_.is_still) {
    title = cycle_.report() ? "Crank since the lift began (°)" : "Crank within the stretch that closes (°)";
  }
  Axis x = degrees_axis(title, turns ? 0.0 : elevations_deg_.front().x(), turns ? 360.0 : elevations_deg_.back().x());
  x.has_grid = false;
  PlotLook look;
  look.text_size = 0.95 * text;
  look.theme = theme_;
  look.has_frame = false;
  return {canvas,
          {card.corner + Point2(0.9 * text, 2.0 * text), card.width - 1.8 * text, card.height - 2.7 * text},
          x,
          y,
          look};
}

void LinkagePanel::draw_curve(Plot& plot, const LinkageSheet& sheet, const std::vector<Point2>& places, Colour colour,
                              double at_deg) const {
  plot.upright(at_deg, {.colour = theme_.quiet, .width = 1.0, .opacity = 0.7});
  plot.line(places, {.colour = colour, .width = 0.19 * sheet.text});
}

void LinkagePanel::draw_elevation(Canvas& canvas, const LinkageSheet& sheet,
                                  const calib::LinkagePosition& position) const {
  const double text = sheet.text;
  const std::string heading = look_.is_still ? "Elevation (°)" : "Elevation θ* (°)";
  draw_heading(canvas, sheet, sheet.elevation, heading);
  const auto [least, most] = least_and_most(elevations_deg_);
  const double margin = std::max(0.05 * (most - least), 0.05);
  Plot plot = plot_on(canvas, sheet, sheet.elevation, degrees_axis("", least - margin, most + margin));
  shade_strokes(plot);
  const auto dot = [&](const calib::LinkagePosition& at, double radius, Colour colour, double edge) {
    canvas.circle(plot.at(axis_deg(at.crank_rad), deg_from_rad(at.elevation_rad)), radius * text,
                  Fill{.colour = colour}, Pen{.colour = theme_.card, .width = edge * text});
  };
  draw_curve(plot, sheet, elevations_deg_, laser_, axis_deg(position.crank_rad));
  dot(cycle_.begin(), 0.36, theme_.text, 0.1);
  dot(cycle_.end(), 0.36, theme_.text, 0.1);
  dot(position, 0.45, laser_, 0.14);
  draw_strokes_key(canvas, sheet, sheet.elevation.corner.x() + 1.2 * text + text_width(heading, 1.08 * text, true));
}

void LinkagePanel::draw_transmission(Canvas& canvas, const LinkageSheet& sheet,
                                     const calib::LinkagePosition& position) const {
  const double text = sheet.text;
  const DrawingArea& card = sheet.transmission;
  draw_heading(canvas, sheet, card, look_.is_still ? "Transmission angle (°)" : "Transmission angle µ (°)");
  Plot plot = plot_on(canvas, sheet, card, degrees_axis("", 0.0, kFolded_deg));
  const DrawingArea& inside = plot.inside();
  const double top_y = plot.at(0.0, kPoor_deg).y();
  canvas.rectangle({inside.corner.x(), top_y}, inside.width, inside.corner.y() + inside.height - top_y,
                   Fill{.colour = theme_.warning, .opacity = 0.10});
  plot.level(kPoor_deg, {.colour = theme_.warning, .width = 1.2, .dashes = "5 4"});
  const double at_deg = axis_deg(position.crank_rad);
  draw_curve(plot, sheet, transmissions_deg_, theme_.curve(0), at_deg);
  mark_least(canvas, sheet, plot);
  canvas.circle(plot.at(at_deg, deg_from_rad(position.pose.transmission_rad)), 0.45 * text,
                Fill{.colour = theme_.curve(0)}, Pen{.colour = theme_.card, .width = 0.14 * text});
  canvas.text(card.corner + Point2(card.width - 1.4 * text, 1.75 * text), "poor below 40°",
              {.size = 0.95 * text, .colour = theme_.warning, .anchor = Anchor::kEnd});
}

void LinkagePanel::mark_least(Canvas& canvas, const LinkageSheet& sheet, const Plot& plot) const {
  const double text = sheet.text;
  const Point2 least = *std::min_element(transmissions_deg_.begin(), transmissions_deg_.end(),
                                         [](const Point2& a, const Point2& b) { return a.y() < b.y(); });
  const Point2 place = plot.at(least.x(), least.y());
  canvas.circle(place, 0.3 * text, Fill{.colour = least.y() < kPoor_deg ? theme_.warning : theme_.text},
                Pen{.colour = theme_.card});
  if (!look_.is_still) return;
  const bool is_left = place.x() < plot.inside().corner.x() + 0.5 * plot.inside().width;
  canvas.text(place + text * Point2(is_left ? 0.7 : -0.7, -0.6), fmt::format("least {:.1f}°", least.y()),
              {.size = 0.9 * text,
               .colour = theme_.text,
               .anchor = is_left ? Anchor::kStart : Anchor::kEnd,
               .is_bold = true,
               .has_halo = true,
               .halo = theme_.card});
}

void LinkagePanel::draw_strokes_key(Canvas& canvas, const LinkageSheet& sheet, double from_x) const {
  const DrawingArea& card = sheet.elevation;
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
