#include "picture/map_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gdtslam::picture {
namespace {

constexpr double kTitleLine = 1.35;  // of the size of the letters
constexpr double kSubtitleLine = 1.5;
constexpr double kRowGap = 0.75;  // of body_px, between rows of the legend
constexpr int kRounds = 3;        // until the scale bar, which depends on the map's size, stands still

double title_height(const MapLook& look, const Proportions& sizes) {
  double height = 0.0;
  if (!look.title.empty()) height += kTitleLine * sizes.title_px;
  if (!look.subtitle.empty()) height += kSubtitleLine * sizes.body_px;
  return height > 0.0 ? height + 0.4 * sizes.body_px : 0.0;
}

/// Where the items go, relative to the legend's upper left corner, and what room they take.
struct Arrangement {
  std::vector<Point2> places;
  double width_px = 0.0;
  double height_px = 0.0;
};

/// Row after row, as words on a page.
Arrangement rows_of(const std::vector<LegendItem>& items, double room_px, const Proportions& sizes) {
  Arrangement all;
  double top = 0.0;
  for (std::size_t begin = 0; begin < items.size();) {
    double x = 0.0;
    double height = 0.0;
    std::size_t end = begin;
    while (end < items.size() && (end == begin || x + items[end].width_px <= room_px)) {
      x += items[end].width_px + sizes.gap_px;
      height = std::max(height, items[end++].height_px);
    }
    x = 0.0;
    for (; begin < end; ++begin) {
      all.places.emplace_back(x, top + 0.5 * height);
      x += items[begin].width_px + sizes.gap_px;
    }
    all.width_px = std::max(all.width_px, x - sizes.gap_px);
    all.height_px = top + height;
    top += height + kRowGap * sizes.body_px;
  }
  return all;
}

Arrangement column_of(const std::vector<LegendItem>& items, const Proportions& sizes) {
  return rows_of(items, 0.0, sizes);
}

struct Layout {
  MapFrame frame;
  Arrangement legend;
  Point2 corner;
};

Panel panel_between(double left, double top, double right, double bottom) {
  const double x = std::floor(left);
  const double y = std::floor(top);
  return {x, y, std::max(1.0, std::floor(right) - x), std::max(1.0, std::floor(bottom) - y)};
}

Layout with_legend_below(const MapArea& area, const PictureSize& size, const Proportions& sizes, double top,
                         const std::vector<LegendItem>& items) {
  const double margin = sizes.margin_px;
  Layout layout;
  layout.legend = rows_of(items, size.width - 2.0 * margin, sizes);
  const double bottom = size.height - 0.7 * margin - layout.legend.height_px;
  layout.corner = {margin, bottom};
  layout.frame = fitted(area, panel_between(margin, top, size.width - margin, bottom - 0.5 * margin));
  return layout;
}

Layout with_legend_beside(const MapArea& area, const PictureSize& size, const Proportions& sizes, double top,
                          const std::vector<LegendItem>& items) {
  const double margin = sizes.margin_px;
  Layout layout;
  layout.legend = column_of(items, sizes);
  const double right = size.width - margin - layout.legend.width_px;
  layout.corner = {right, size.height - margin - layout.legend.height_px};
  layout.frame = fitted(area, panel_between(margin, top, right - margin, size.height - margin));
  return layout;
}

}  // namespace

Sheet sheet_of(const MapArea& area, const MapLook& look, const PictureSize& size, const LegendOf& legend) {
  Sheet sheet{.size = size, .sizes = proportions_of(size), .frame = {}, .items = {}, .places = {}};
  const double width = static_cast<double>(size.width);
  const double height = static_cast<double>(size.height);
  sheet.frame = fitted(area, {0.0, 0.0, width, height});
  if (std::min(size.width, size.height) < kLeastSideWithWords) return sheet;
  const double top = 0.7 * sheet.sizes.margin_px + title_height(look, sheet.sizes);
  for (int round = 0; round < kRounds; ++round) {
    sheet.items = legend(sheet.frame.px_per_m);
    Layout layout = with_legend_below(area, size, sheet.sizes, top, sheet.items);
    Layout beside = with_legend_beside(area, size, sheet.sizes, top, sheet.items);
    const bool fits_beside = beside.legend.height_px + top + sheet.sizes.margin_px <= height;
    if (fits_beside && beside.frame.px_per_m > layout.frame.px_per_m) layout = std::move(beside);
    sheet.frame = layout.frame;
    sheet.places = std::move(layout.legend.places);
    for (Point2& place : sheet.places) place += layout.corner;
  }
  return sheet;
}

FittedWords fitted_words(const std::string& words, double size_px, double least_px, double room_px, bool is_bold) {
  FittedWords fitted{words, size_px};
  const double width = text_width(words, size_px, is_bold);
  if (width <= room_px) return fitted;
  fitted.size_px = std::max(std::min(size_px, least_px), size_px * room_px / width);
  while (!fitted.text.empty() && text_width(fitted.text + "…", fitted.size_px, is_bold) > room_px) {
    // A letter may take several bytes: those that continue one go with it.
    while (!fitted.text.empty() && (static_cast<unsigned char>(fitted.text.back()) & 0xC0U) == 0x80U) {
      fitted.text.pop_back();
    }
    if (!fitted.text.empty()) fitted.text.pop_back();
    if (text_width(fitted.text + "…", fitted.size_px, is_bold) <= room_px) fitted.text += "…";
    if (fitted.text.ends_with("…")) break;
  }
  return fitted;
}

void draw_title(Canvas& canvas, const Sheet& sheet, const MapLook& look) {
  if (sheet.places.empty()) return;
  const Proportions& sizes = sheet.sizes;
  const double room = sheet.size.width - 2.0 * sizes.margin_px;
  double y = 0.7 * sizes.margin_px;
  if (!look.title.empty()) {
    const FittedWords words = fitted_words(look.title, sizes.title_px, sizes.body_px, room, true);
    canvas.text({sizes.margin_px, y + 0.8 * sizes.title_px}, words.text, {.size = words.size_px, .is_bold = true});
    y += kTitleLine * sizes.title_px;
  }
  if (!look.subtitle.empty()) {
    const FittedWords words = fitted_words(look.subtitle, sizes.body_px, 0.8 * sizes.body_px, room, false);
    canvas.text({sizes.margin_px, y + 0.8 * sizes.body_px}, words.text, {.size = words.size_px, .colour = ink::kQuiet});
  }
}

void draw_legend(Canvas& canvas, const Sheet& sheet) {
  for (std::size_t i = 0; i < sheet.places.size(); ++i) sheet.items[i].draw(canvas, sheet.places[i]);
}

}  // namespace gdtslam::picture
