#include <algorithm>
#include <cmath>

#include "linkage_panel.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastText = 10.5;
constexpr double kTextShare = 0.0182;  ///< of the picture's height: 13 pixels of 720
constexpr double kPanelShare = 0.39;   ///< of a wide picture's width
/// Below these a panel would leave no room for the linkage.
constexpr double kLeastWidth = 360.0;
constexpr double kLeastHeight = 240.0;
constexpr double kRoomyHeight = 38.0;  ///< of the panel, in letters: enough for a plot of the transmission angle

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

PictureSize LinkageSheet::scene_size() const {
  return {static_cast<std::uint32_t>(std::max(1.0, scene.width)),
          static_cast<std::uint32_t>(std::max(1.0, scene.height))};
}

LinkageSheet sheet_for(const PictureSize& size, bool with_panel) {
  const double width = size.width;
  const double height = size.height;
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
  DrawingArea card = body;
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
  return sheet;
}

}  // namespace gdtslam
