#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gdtslam/core/angle.hpp"
#include "linkage_drawing.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastText = 10.5;
constexpr double kTextShare = 0.0182;  ///< share of the picture's height: 13 pixels of 720
constexpr double kPanelShare = 0.39;   ///< share of a wide picture's width
/// Below these sizes a panel would leave no room for the linkage.
constexpr double kLeastWidth = 360.0;
constexpr double kLeastHeight = 240.0;
constexpr double kRoomyHeight = 38.0;  ///< height of the panel, in letters: enough for a plot of the transmission angle
constexpr double kPoor_deg = 40.0;     ///< calib::kPoorTransmission_rad in degrees
constexpr Fill kLift{.colour = ink::kRocker, .opacity = 0.10};
constexpr Fill kReturn{.colour = ink::kCrank, .opacity = 0.09};
constexpr double kKeyStrength = 2.2;  ///< a small patch needs a stronger colour

/// Sorts by the crank, with a gap if a curve leaves the axis at one side and returns on the other.
std::vector<Point2> in_order(std::vector<Point2> curve, bool is_turning) {
  constexpr double kMostJump_deg = 180.0;
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  std::sort(curve.begin(), curve.end(), [](const Point2& a, const Point2& b) { return a.x() < b.x(); });
  const Point2 first = curve.front();
  const Point2 last = curve.back();
  // Extends to both ends of the axis, unless a rocker completes a turn there.
  if (is_turning && std::fabs(last.y() - first.y()) < kMostJump_deg) {
    curve.insert(curve.begin(), {last.x() - 360.0, last.y()});
    curve.push_back({first.x() + 360.0, first.y()});
  }
  std::vector<Point2> whole;
  for (const Point2& place : curve) {
    const bool jumps = !whole.empty() && std::fabs(place.y() - whole.back().y()) > kMostJump_deg;
    if (jumps) whole.emplace_back(place.x(), kNothing);
    whole.push_back(place);
  }
  return whole;
}

void lay_out_panel(LinkageSheet& sheet, const DrawingArea& panel) {
  const double text = sheet.text;
  const bool is_roomy = panel.height >= kRoomyHeight * text;
  sheet.figures = {panel.corner, panel.width, 5.4 * text};
  const double rest = panel.height - sheet.figures.height - text;
  const double elevation = is_roomy ? std::floor(0.56 * (rest - text)) : rest;
  sheet.elevation = {panel.corner + Point2(0.0, sheet.figures.height + text), panel.width, elevation};
  if (!is_roomy) return;
  sheet.transmission = {sheet.elevation.corner + Point2(0.0, elevation + text), panel.width, rest - elevation - text};
}

/// Shades a range of crank angles from a start in a direction, in pieces if the axis ends in between.
void draw_stretch(Plot& plot, double from_deg, double span_deg, const Fill& fill) {
  const double low = span_deg < 0.0 ? from_deg + span_deg : from_deg;
  for (const double turn : {-360.0, 0.0, 360.0}) {
    const double from = std::clamp(low + turn, 0.0, 360.0);
    const double to = std::clamp(low + std::fabs(span_deg) + turn, 0.0, 360.0);
    if (to > from) plot.stretch(from, to, fill);
  }
}

bool is_lower(const Point2& a, const Point2& b) { return a.y() < b.y(); }  // false for a gap

}  // namespace

LinkageSheet linkage_sheet(double width, double height, bool with_panel) {
  LinkageSheet sheet;
  sheet.text = std::max(kLeastText, kTextShare * std::min(height, 0.75 * width));
  sheet.scene = {Point2::Zero(), width, height};
  if (!with_panel || std::max(width, height) < kLeastWidth || std::min(width, height) < kLeastHeight) return sheet;
  const double text = sheet.text;
  const double margin = std::round(1.4 * text);
  const double header = std::round((height < 45.0 * text ? 2.4 : 4.4) * text);
  sheet.header = {{margin, margin}, width - 2.0 * margin, header};
  const DrawingArea body{{margin, margin + header}, width - 2.0 * margin, height - 2.0 * margin - header};
  DrawingArea panel = body;
  DrawingArea& card = sheet.card = body;
  if (width > 1.15 * height) {
    panel.width = std::round(std::max(kPanelShare * width, 25.0 * text));
    card.width = body.width - panel.width - text;
    panel.corner.x() += card.width + text;
  } else {
    card.height = std::round(0.5 * body.height);
    panel.corner.y() += card.height + text;
    panel.height -= card.height + text;
  }
  lay_out_panel(sheet, panel);
  // One row, two rows, or none if the bars' lengths have no room.
  const double rows = card.width > 46.0 * text ? 2.6 : (card.width > 30.0 * text ? 4.2 : 0.6);
  const double bars = std::round(rows * text);
  // One pixel inside the card, to keep its edge.
  sheet.scene = {card.corner + Point2(1.0, std::round(0.6 * text)), card.width - 2.0,
                 std::floor(card.height - bars - 0.6 * text)};
  sheet.bars = {card.corner + Point2(0.0, card.height - bars), card.width, bars};
  return sheet;
}

std::string degrees_text(double angle_rad) {
  std::string text = fmt::format("{:.1f}", deg_from_rad(angle_rad));
  return text == "-0.0" ? "0.0" : text;
}

LinkagePanel::LinkagePanel(const calib::LinkageCycle& cycle, bool is_dark, bool is_transparent)
    : cycle_(cycle),
      is_transparent_(is_transparent),
      theme_(is_dark ? kDarkTheme : kLightTheme),
      laser_(is_dark ? theme_.curve(4) : ink::kLaser),
      laser_text_(is_dark ? theme_.curve(4) : ink::kLaserText) {
  const bool is_whole = cycle.turns_fully();
  for (std::size_t i = 0; i + (is_whole ? 1 : 0) < cycle.positions().size(); ++i) {
    const calib::LinkagePosition& position = cycle.positions()[i];
    const double at_deg = axis_deg(position.crank_rad);
    elevations_deg_.emplace_back(at_deg, deg_from_rad(position.elevation_rad));
    transmissions_deg_.emplace_back(at_deg, deg_from_rad(position.pose.transmission_rad));
  }
  elevations_deg_ = in_order(std::move(elevations_deg_), is_whole);
  transmissions_deg_ = in_order(std::move(transmissions_deg_), is_whole);
}

double LinkagePanel::axis_deg(double crank_rad) const {
  const double crank_deg = deg_from_rad(crank_rad);
  return cycle_.turns_fully() ? crank_deg - 360.0 * std::floor(crank_deg / 360.0) : crank_deg;
}

void LinkagePanel::draw_ground(Canvas& canvas, const LinkageSheet& sheet) const {
  constexpr double kRadius = 9.0;
  if (!is_transparent_) {
    canvas.rectangle(Point2::Zero(), canvas.width(), canvas.height(), Fill{.colour = theme_.page});
  }
  for (const DrawingArea* card : {&sheet.card, &sheet.figures, &sheet.elevation, &sheet.transmission}) {
    if (card->width <= 0.0) continue;
    canvas.rectangle(card->corner, card->width, card->height, Fill{.colour = theme_.card}, Pen{.colour = theme_.edge},
                     kRadius);
  }
  draw_header(canvas, sheet);
  draw_bars(canvas, sheet);
}

void LinkagePanel::draw_readings(Canvas& canvas, const LinkageSheet& sheet,
                                 const calib::LinkagePosition& position) const {
  draw_figures(canvas, sheet, position);
  draw_elevation(canvas, sheet, position);
  if (sheet.transmission.width > 0.0) draw_transmission(canvas, sheet, position);
}

void LinkagePanel::draw_sweep_label(Canvas& canvas, const LinkageSheet& sheet, const Point2& rim, const Point2& inner,
                                    double elevation_rad) const {
  const Point2 away = (rim - inner).normalized();
  const double text = 1.05 * sheet.text;
  const bool is_side = std::fabs(away.x()) > 0.6;
  const std::string words = degrees_text(elevation_rad) + "°";
  const double width = text_width(words, text, true);
  // Aligned by its left end, which keeps it within the card if the rim is close to the edge.
  const double share = !is_side ? 0.5 : (away.x() > 0.0 ? 0.0 : 1.0);
  const double left = rim.x() - sheet.scene.corner.x() + 0.6 * text * away.x() - share * width;
  const double drop = is_side ? 0.35 : (away.y() < 0.0 ? -0.4 : 1.2);
  const double most = std::max(0.4 * text, sheet.scene.width - width - 0.4 * text);
  canvas.text({sheet.scene.corner.x() + std::clamp(left, 0.4 * text, most), rim.y() + drop * text}, words,
              {.size = text, .colour = laser_text_, .is_bold = true, .has_halo = true, .halo = theme_.card});
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
                     {"ground", bars.ground_m, theme_.quiet}};
  const double text = sheet.text;
  if (sheet.bars.height < 2.0 * text) return;
  const int columns = sheet.bars.height > 3.5 * text ? 2 : 4;
  const double step = (sheet.bars.width - 2.8 * text) / columns;
  for (int i = 0; i < 4; ++i) {
    const Bar& bar = all[i];
    const int row = i / columns;
    const Point2 at = sheet.bars.corner + text * Point2(1.4, 1.5 + 1.6 * row) + Point2(step * (i % columns), 0.0);
    canvas.line(at + text * Point2(0.0, -0.36), at + text * Point2(1.6, -0.36),
                {.colour = bar.colour, .width = 0.5 * text});
    const Point2 words = at + Point2(2.4 * text, 0.0);
    canvas.text(words, bar.name, {.size = text, .colour = theme_.text});
    canvas.text(words + Point2(text_width(std::string(bar.name) + " ", text), 0.0),
                fmt::format("{:.5g} cm", 100.0 * bar.length_m), {.size = text, .colour = theme_.text, .is_bold = true});
  }
}

void LinkagePanel::draw_figures(Canvas& canvas, const LinkageSheet& sheet,
                                const calib::LinkagePosition& position) const {
  struct Figure {
    const char* meaning;
    double angle_rad;
    Colour colour;
  };
  const double text = sheet.text;
  const bool is_poor = position.pose.transmission_rad < calib::kPoorTransmission_rad;
  const double crank_rad = position.crank_rad - kTwoPi * std::floor(position.crank_rad / kTwoPi);
  const Figure figures[] = {
      {"θ crank", crank_rad, theme_.curve(1)},
      {"θ* elevation", position.elevation_rad, laser_text_},
      {"µ transmission", position.pose.transmission_rad, is_poor ? theme_.warning : theme_.curve(0)}};
  const double step = (sheet.figures.width - 2.4 * text) / 3.0;
  const double value_size = std::min(2.0, 0.88 * step / text_width("000.0°", text, true)) * text;
  Point2 at = sheet.figures.corner + text * Point2(1.2, 1.9);
  for (const Figure& figure : figures) {
    canvas.text(at, figure.meaning, {.size = 0.95 * text, .colour = theme_.quiet});
    canvas.text(at + Point2(0.0, 2.4 * text), degrees_text(figure.angle_rad) + "°",
                {.size = value_size, .colour = figure.colour, .is_bold = true});
    at.x() += step;
  }
}

Plot LinkagePanel::plot_on(Canvas& canvas, const LinkageSheet& sheet, const DrawingArea& card, std::string_view heading,
                           double from, double to) const {
  const double text = sheet.text;
  canvas.text(card.corner + text * Point2(1.2, 1.75), heading,
              {.size = 1.08 * text, .colour = theme_.text, .is_bold = true});
  const bool turns = cycle_.turns_fully();
  return {canvas,
          {card.corner + text * Point2(0.9, 2.0), card.width - 1.8 * text, card.height - 2.7 * text},
          {.title = "Crank angle (°)",
           .from = turns ? 0.0 : elevations_deg_.front().x(),
           .to = turns ? 360.0 : elevations_deg_.back().x(),
           .steps = TickSteps::kDegrees,
           .has_grid = false},
          {.from = from, .to = to, .steps = TickSteps::kDegrees},
          {.text_size = 0.95 * text, .theme = theme_, .has_frame = false}};
}

void LinkagePanel::shade_strokes(Plot& plot) const {
  if (!cycle_.report()) return;
  const double begin_deg = axis_deg(cycle_.begin().crank_rad);
  const double turn_deg = deg_from_rad(cycle_.span_rad());
  const double lift_deg = turn_deg * cycle_.report()->lift_share;
  draw_stretch(plot, begin_deg, lift_deg, kLift);
  draw_stretch(plot, begin_deg + lift_deg, turn_deg - lift_deg, kReturn);
}

void LinkagePanel::draw_elevation(Canvas& canvas, const LinkageSheet& sheet,
                                  const calib::LinkagePosition& position) const {
  const double text = sheet.text;
  const char* const heading = "Elevation θ* (°)";
  const double least = deg_from_rad(cycle_.lowest_rad());
  const double most = deg_from_rad(cycle_.highest_rad());
  const double margin = std::max(0.05 * (most - least), 0.05);
  Plot plot = plot_on(canvas, sheet, sheet.elevation, heading, least - margin, most + margin);
  shade_strokes(plot);
  const auto dot = [&](const calib::LinkagePosition& at, double radius, Colour colour, double edge) {
    canvas.circle(plot.at(axis_deg(at.crank_rad), deg_from_rad(at.elevation_rad)), radius * text,
                  Fill{.colour = colour}, Pen{.colour = theme_.card, .width = edge * text});
  };
  plot.upright(axis_deg(position.crank_rad), {.colour = theme_.quiet, .width = 1.0, .opacity = 0.7});
  plot.line(elevations_deg_, {.colour = laser_, .width = 0.19 * text});
  dot(cycle_.begin(), 0.36, theme_.text, 0.1);
  dot(cycle_.end(), 0.36, theme_.text, 0.1);
  dot(position, 0.45, laser_, 0.14);
  draw_strokes_key(canvas, sheet, sheet.elevation.corner.x() + 1.2 * text + text_width(heading, 1.08 * text, true));
}

void LinkagePanel::draw_transmission(Canvas& canvas, const LinkageSheet& sheet,
                                     const calib::LinkagePosition& position) const {
  const double text = sheet.text;
  const DrawingArea& card = sheet.transmission;
  Plot plot = plot_on(canvas, sheet, card, "Transmission angle µ (°)", 0.0, 90.0);
  const double at_deg = axis_deg(position.crank_rad);
  plot.level(kPoor_deg, {.colour = theme_.warning, .width = 1.2, .dashes = "5 4"});
  plot.upright(at_deg, {.colour = theme_.quiet, .width = 1.0, .opacity = 0.7});
  plot.line(transmissions_deg_, {.colour = theme_.curve(0), .width = 0.19 * text});
  const Point2 least = *std::min_element(transmissions_deg_.begin(), transmissions_deg_.end(), is_lower);
  const Point2 place = plot.at(least.x(), least.y());
  canvas.circle(place, 0.3 * text, Fill{.colour = least.y() < kPoor_deg ? theme_.warning : theme_.text},
                Pen{.colour = theme_.card});
  canvas.circle(plot.at(at_deg, deg_from_rad(position.pose.transmission_rad)), 0.45 * text,
                Fill{.colour = theme_.curve(0)}, Pen{.colour = theme_.card, .width = 0.14 * text});
  canvas.text(card.corner + Point2(card.width - 1.4 * text, 1.75 * text),
              fmt::format("least {:.1f}°, poor below {:g}°", least.y(), kPoor_deg),
              {.size = 0.95 * text, .colour = theme_.warning, .anchor = Anchor::kEnd});
}

void LinkagePanel::draw_strokes_key(Canvas& canvas, const LinkageSheet& sheet, double from_x) const {
  if (!cycle_.report()) return;
  const DrawingArea& card = sheet.elevation;
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
