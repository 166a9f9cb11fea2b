#include "linkage_drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastText = 10.5;
constexpr double kTextShare = 0.0182;  ///< of the picture's height: 13 pixels of 720
constexpr double kPanelShare = 0.39;   ///< of a wide picture's width
/// Below these a panel would leave no room for the linkage.
constexpr double kLeastWidth = 360.0;
constexpr double kLeastHeight = 240.0;
constexpr double kRoomyHeight = 38.0;  ///< of the panel, in letters: enough for a plot of the transmission angle

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

void lay_out_panel(LinkageSheet& sheet, const DrawingArea& panel) {
  const double text = sheet.text;
  const double gap = text;
  const bool is_roomy = panel.height >= kRoomyHeight * text;
  sheet.figures = {panel.corner, panel.width, (is_roomy ? 6.6 : 7.4) * text};
  const double rest = panel.height - sheet.figures.height - gap;
  const double elevation = is_roomy ? std::floor(0.56 * (rest - gap)) : rest;
  sheet.elevation = {panel.corner + Point2(0.0, sheet.figures.height + gap), panel.width, elevation};
  if (!is_roomy) return;
  sheet.transmission = {sheet.elevation.corner + Point2(0.0, elevation + gap), panel.width, rest - elevation - gap};
}

}  // namespace

LinkageSheet linkage_sheet(double width, double height, bool with_panel) {
  LinkageSheet sheet;
  sheet.text = std::max(kLeastText, kTextShare * std::min(height, 0.75 * width));
  sheet.scene = {Point2::Zero(), width, height};
  if (!with_panel || std::max(width, height) < kLeastWidth || std::min(width, height) < kLeastHeight) return sheet;
  const double text = sheet.text;
  const double margin = std::round(1.4 * text);
  const bool is_small = height < 45.0 * text;
  const double header = std::round((is_small ? 2.4 : 4.4) * text);
  sheet.header = {{margin, margin}, width - 2.0 * margin, header};
  DrawingArea body{{margin, margin + header}, width - 2.0 * margin, height - 2.0 * margin - header};
  DrawingArea panel;
  DrawingArea& card = sheet.card = body;
  if (width > 1.15 * height) {
    panel.width = std::round(std::max(kPanelShare * width, 25.0 * text));
    panel.height = body.height;
    card.width = body.width - panel.width - text;
    panel.corner = body.corner + Point2(card.width + text, 0.0);
  } else {
    card.height = std::round(0.5 * body.height);
    panel = {body.corner + Point2(0.0, card.height + text), body.width, body.height - card.height - text};
  }
  lay_out_panel(sheet, panel);
  // One row, two rows, or no room for the bars' lengths.
  const double rows = card.width > 46.0 * text ? 2.6 : (card.width > 30.0 * text ? 4.2 : 0.6);
  const double bars = std::round(rows * text);
  // One pixel inside the card, whose edge stays.
  sheet.scene = {card.corner + Point2(1.0, std::round(0.6 * text)), card.width - 2.0,
                 std::floor(card.height - bars - 0.6 * text)};
  sheet.bars = {card.corner + Point2(0.0, card.height - bars), card.width, bars};
  // As high as what is on it: the scene has whole pixels.
  card.height = sheet.scene.height + 0.6 * text + bars;
  card.corner.y() = sheet.bars.corner.y() + bars - card.height;
  return sheet;
}

std::string degrees_text(double angle_rad) {
  std::string text = fmt::format("{:.1f}", deg_from_rad(angle_rad));
  return text == "-0.0" ? "0.0" : text;
}

LinkagePanel::LinkagePanel(const calib::LinkageCycle& cycle, const LinkagePanelLook& look)
    : cycle_(cycle),
      look_(look),
      theme_(look.is_dark ? kDarkTheme : kLightTheme),
      laser_(look.is_dark ? theme_.curve(4) : ink::kLaser),
      laser_text_(look.is_dark ? theme_.curve(4) : ink::kLaserText) {
  std::vector<Point2> elevations;
  std::vector<Point2> transmissions;
  const bool is_whole = cycle.turns_fully();
  for (std::size_t i = 0; i + (is_whole ? 1 : 0) < cycle.positions().size(); ++i) {
    const calib::LinkagePosition& position = cycle.positions()[i];
    const double at_deg = axis_deg(position.crank_rad);
    elevations.emplace_back(at_deg, deg_from_rad(position.elevation_rad));
    transmissions.emplace_back(at_deg, deg_from_rad(position.pose.transmission_rad));
  }
  elevations_deg_ = in_order(std::move(elevations), is_whole, 180.0);
  transmissions_deg_ = in_order(std::move(transmissions), is_whole, 180.0);
}

double LinkagePanel::axis_deg(double crank_rad) const {
  if (look_.is_still) return deg_from_rad(cycle_.since_begin_rad(crank_rad));
  const double crank_deg = deg_from_rad(crank_rad);
  return cycle_.turns_fully() ? crank_deg - 360.0 * std::floor(crank_deg / 360.0) : crank_deg;
}

void LinkagePanel::draw_ground(Canvas& canvas, const LinkageSheet& sheet) const {
  constexpr double kRadius = 9.0;
  if (!look_.is_transparent) {
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

void LinkagePanel::draw_heading(Canvas& canvas, const LinkageSheet& sheet, const DrawingArea& card,
                                std::string_view words) const {
  canvas.text(card.corner + sheet.text * Point2(1.2, 1.75), words,
              {.size = 1.08 * sheet.text, .colour = theme_.text, .is_bold = true});
}

void LinkagePanel::draw_sweep_label(Canvas& canvas, const LinkageSheet& sheet, const Point2& rim, const Point2& inner,
                                    double elevation_rad) const {
  const Point2 away = (rim - inner).normalized();
  const double text = 1.05 * sheet.text;
  const bool is_side = std::fabs(away.x()) > 0.6;
  const std::string words = degrees_text(elevation_rad) + "°";
  const double width = text_width(words, text, true);
  // By its left end, which keeps it within the card where the rim comes close to the edge.
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

void LinkagePanel::draw_figures(Canvas& canvas, const LinkageSheet& sheet,
                                const calib::LinkagePosition& position) const {
  struct Figure {
    std::string symbol;
    std::string index;  ///< small, below the line
    std::string meaning;
    double angle_rad;
    Colour colour;
  };
  const double text = sheet.text;
  const bool is_poor = position.pose.transmission_rad < calib::kPoorTransmission_rad;
  const double crank_rad = position.crank_rad - kTwoPi * std::floor(position.crank_rad / kTwoPi);
  const Figure figures[] = {
      {"θ", "input", "crank", crank_rad, theme_.curve(1)},
      {"θ*", "", "elevation", position.elevation_rad, laser_text_},
      {"µ", "", "transmission", position.pose.transmission_rad, is_poor ? theme_.warning : theme_.curve(0)}};
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
    canvas.text(at + Point2(0.0, 2.6 * text), degrees_text(figure.angle_rad) + "°",
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
