#include "linkage_panel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kPoor_deg = 40.0;  ///< calib::kPoorTransmission_rad as it is written
std::string degrees(double angle_deg) {
  const double rounded = std::round(10.0 * angle_deg) / 10.0;
  return fmt::format("{:.1f}°", rounded == 0.0 ? 0.0 : rounded);
}

double turned_into_axis(double angle_deg) { return angle_deg - 360.0 * std::floor(angle_deg / 360.0); }

/// By the crank, with a gap where a curve leaves the axis at one side and comes back on the other.
std::vector<Point2> in_order(std::vector<Point2> curve, bool is_turning, double most_jump) {
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  std::sort(curve.begin(), curve.end(), [](const Point2& a, const Point2& b) { return a.x() < b.x(); });
  const Point2 first = curve.front();
  const Point2 last = curve.back();
  // Up to both ends of the axis, unless it is there that a rocker has gained a whole turn.
  if (is_turning && std::fabs(last.y() - first.y()) < most_jump) {
    curve.insert(curve.begin(), {last.x() - 360.0, last.y()});
    curve.push_back({first.x() + 360.0, first.y()});
  }
  std::vector<Point2> whole;
  for (const Point2& place : curve) {
    if (!whole.empty() && std::fabs(place.y() - whole.back().y()) > most_jump) whole.emplace_back(place.x(), kNothing);
    whole.push_back(place);
  }
  return whole;
}

}  // namespace

struct LinkagePanel::Figure {
  std::string symbol;
  std::string index;  ///< small, below the line
  std::string meaning;
  std::string value;
  Colour colour;
};

LinkagePanel::LinkagePanel(const LinkageCycle& cycle, const LinkageLook& look)
    : cycle_(cycle), look_(look), theme_(look.is_dark ? kDarkTheme : kLightTheme) {
  std::vector<Point2> elevations;
  std::vector<Point2> transmissions;
  const bool is_whole = cycle.turns_fully();
  for (std::size_t i = 0; i + (is_whole ? 1 : 0) < cycle.positions().size(); ++i) {
    const LinkagePosition& position = cycle.positions()[i];
    const double at_deg = axis_deg(position.crank_rad);
    elevations.emplace_back(at_deg, deg_from_rad(position.elevation_rad));
    transmissions.emplace_back(at_deg, deg_from_rad(position.pose.transmission_rad));
  }
  elevations_deg_ = in_order(std::move(elevations), is_whole, 180.0);
  transmissions_deg_ = in_order(std::move(transmissions), is_whole, 180.0);
}

double LinkagePanel::axis_deg(double crank_rad) const {
  const double crank_deg = deg_from_rad(crank_rad);
  return cycle_.turns_fully() ? turned_into_axis(crank_deg) : crank_deg;
}

void LinkagePanel::draw_card(Canvas& canvas, const DrawingArea& area) const {
  constexpr double kRadius = 9.0;
  if (area.width <= 0.0) return;
  canvas.rectangle(area.corner, area.width, area.height, Fill{.colour = theme_.card}, Pen{.colour = theme_.edge},
                   kRadius);
}

void LinkagePanel::draw_ground(Canvas& canvas, const LinkageSheet& sheet) const {
  if (!look_.is_transparent) {
    canvas.rectangle(Point2::Zero(), canvas.width(), canvas.height(), Fill{.colour = theme_.page});
  }
  const double top = 0.6 * sheet.text;
  draw_card(canvas, {sheet.bars.corner - Point2(0.0, sheet.scene.height + top), sheet.bars.width,
                     sheet.scene.height + top + sheet.bars.height});
  for (const DrawingArea* card : {&sheet.figures, &sheet.elevation, &sheet.transmission}) draw_card(canvas, *card);
  draw_header(canvas, sheet);
  draw_bars(canvas, sheet);
}

void LinkagePanel::draw_header(Canvas& canvas, const LinkageSheet& sheet) const {
  const double text = sheet.text;
  const bool is_small = sheet.header.height < 3.0 * text;
  const calib::SweepModel& model = cycle_.model();
  const std::string name = model.name.empty() ? "linkage" : model.name;
  const double size = (is_small ? 1.5 : 2.0) * text;
  const Point2 at = sheet.header.corner + Point2(0.0, is_small ? 1.2 * text : 1.5 * text);
  canvas.text(at, name, {.size = size, .colour = theme_.text, .is_bold = true});
  std::string words = calib::class_name(cycle_.grashof());
  const std::string more = fmt::format("  ·  {}  ·  {} assembly", calib::inequality_text(model.bars),
                                       model.assembly == calib::Assembly::kOpen ? "open" : "crossed");
  const Point2 below =
      is_small ? at + Point2(text_width(name, size, true) + 1.2 * text, 0.0) : at + Point2(0.0, 1.75 * text);
  const double room = sheet.header.corner.x() + sheet.header.width - below.x();
  if (text_width(words + more, 1.08 * text) <= room) words += more;
  canvas.text(below, words, {.size = 1.08 * text, .colour = theme_.quiet});
}

void LinkagePanel::draw_bars(Canvas& canvas, const LinkageSheet& sheet) const {
  struct Bar {
    const char* name;
    double length_m;
    Colour colour;
  };
  const calib::FourBar& bars = cycle_.model().bars;
  const Bar all[] = {{"crank", bars.crank_m, ink::kCrank},
                     {"coupler", bars.coupler_m, ink::kCoupler},
                     {"rocker", bars.rocker_m, ink::kRocker},
                     {"ground", bars.ground_m, look_.is_dark ? theme_.quiet : ink::kGround}};
  const double text = sheet.text;
  if (sheet.bars.height < 2.0 * text) return;
  const int columns = sheet.bars.height > 3.5 * text ? 2 : 4;
  const double step = (sheet.bars.width - 2.8 * text) / columns;
  int i = 0;
  for (const Bar& bar : all) {
    const int row = i / columns;
    const Point2 at = sheet.bars.corner + Point2(1.4 * text + step * (i % columns), 1.5 * text + 1.6 * text * row);
    canvas.line(at + Point2(0.0, -0.36 * text), at + Point2(1.6 * text, -0.36 * text),
                {.colour = bar.colour, .width = 0.5 * text});
    const Point2 words = at + Point2(2.4 * text, 0.0);
    canvas.text(words, bar.name, {.size = text, .colour = theme_.text});
    canvas.text(words + Point2(text_width(std::string(bar.name) + " ", text), 0.0),
                fmt::format("{:.4g} cm", 100.0 * bar.length_m), {.size = text, .colour = theme_.text, .is_bold = true});
    ++i;
  }
}

void LinkagePanel::draw_read_outs(Canvas& canvas, const LinkageSheet& sheet, const LinkagePosition& position) const {
  if (sheet.figures.width <= 0.0) return;
  draw_figures(canvas, sheet, position);
  draw_elevation(canvas, sheet, position);
  if (sheet.transmission.width > 0.0) draw_transmission(canvas, sheet, position);
}

void LinkagePanel::draw_figures(Canvas& canvas, const LinkageSheet& sheet, const LinkagePosition& position) const {
  const double text = sheet.text;
  const double transmission_deg = deg_from_rad(position.pose.transmission_rad);
  const bool is_poor = position.pose.transmission_rad < calib::kPoorTransmission_rad;
  const Figure figures[] = {
      {"θ", "input", "crank", degrees(turned_into_axis(deg_from_rad(position.crank_rad))), theme_.curve(1)},
      {"θ*", "", "elevation", degrees(deg_from_rad(position.elevation_rad)),
       look_.is_dark ? theme_.curve(4) : ink::kLaserText},
      {"µ", "", "transmission", degrees(transmission_deg), is_poor ? theme_.warning : theme_.curve(0)}};
  const double step = (sheet.figures.width - 2.4 * text) / 3.0;
  const double value_size = std::min(2.0, 0.88 * step / text_width("000.0°", text, true)) * text;
  Point2 at = sheet.figures.corner + Point2(1.2 * text, 1.9 * text);
  for (const Figure& figure : figures) {
    const double symbol = text_width(figure.symbol, 1.1 * text, true);
    canvas.text(at, figure.symbol, {.size = 1.1 * text, .colour = theme_.text, .is_bold = true});
    canvas.text(at + Point2(symbol + 1.0, 0.3 * text), figure.index, {.size = 0.8 * text, .colour = theme_.text});
    const double index = figure.index.empty() ? 0.0 : 1.0 + text_width(figure.index, 0.8 * text);
    canvas.text(at + Point2(symbol + index + 0.5 * text, 0.0), figure.meaning,
                {.size = 0.95 * text, .colour = theme_.quiet});
    canvas.text(at + Point2(0.0, 2.6 * text), figure.value,
                {.size = value_size, .colour = figure.colour, .is_bold = true});
    at.x() += step;
  }
  const double left = sheet.figures.corner.x() + 1.2 * text + 2.0 * step;
  draw_gauge(canvas, sheet, {{left, sheet.figures.corner.y() + 5.3 * text}, step - 0.4 * text, 0.45 * text},
             position.pose.transmission_rad);
}

void LinkagePanel::draw_gauge(Canvas& canvas, const LinkageSheet& sheet, const DrawingArea& area,
                              double transmission_rad) const {
  const double text = sheet.text;
  const auto at = [&](double angle_deg) -> Point2 { return area.corner + Point2(area.width * angle_deg / 90.0, 0.0); };
  const double radius = 0.5 * area.height;
  canvas.rectangle(area.corner, area.width, area.height, Fill{.colour = theme_.grid}, std::nullopt, radius);
  canvas.rectangle(area.corner, at(kPoor_deg).x() - area.corner.x(), area.height,
                   Fill{.colour = theme_.warning, .opacity = 0.25}, std::nullopt, radius);
  const Point2 mark = at(deg_from_rad(transmission_rad)) + Point2(0.0, radius);
  const bool is_poor = transmission_rad < calib::kPoorTransmission_rad;
  canvas.circle(mark, 0.42 * text, Fill{.colour = is_poor ? theme_.warning : theme_.curve(0)},
                Pen{.colour = theme_.card, .width = 1.5});
  if (sheet.transmission.width > 0.0) return;
  canvas.line(at(kPoor_deg) + Point2(0.0, area.height), at(kPoor_deg) + Point2(0.0, area.height + 0.3 * text),
              {.colour = theme_.warning});
  canvas.text(at(kPoor_deg) + Point2(0.0, area.height + 1.25 * text), "limit 40°",
              {.size = 0.88 * text, .colour = theme_.warning, .anchor = Anchor::kMiddle});
}

}  // namespace gdtslam
