#include "stroke_font.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace gdtslam {
namespace {

// A glyph is a list of strokes, a stroke a list of points "xy" on a grid: baseline y = 0, small letters up to 4,
// capitals up to 6, 'a' and 'b' below the baseline (-1, -2). A stroke that starts with '~' is the control polygon of a
// quadratic B-spline, closed when its ends meet.
constexpr std::array<std::string_view, 95> kGlyphs = {
    "",                                     // space
    "0602 0000",                            // !
    "0605 1615",                            // "
    "1016 3036 0242 0444",                  // #
    "~3536060333300001 1016",               // $
    "0046 ~0616150506 ~3141403031",         // %
    "~4012152636340201 ~0100203042",        // &
    "0605",                                 // '
    "~16040210",                            // (
    "~06141200",                            // )
    "0343 1135 1531",                       // *
    "0242 2024",                            // +
    "000a",                                 // ,
    "0222",                                 // -
    "0000",                                 // .
    "0036",                                 // /
    "~06363330000306",                      // 0
    "051610",                               // 1
    "~050636342200 0030",                   // 2
    "~0506363313 ~1333300001",              // 3
    "20260232",                             // 4
    "360603 ~031434300001",                 // 5
    "~3536060302 ~0434300004",              // 6
    "063610",                               // 7
    "~0636330306 ~0333300003",              // 8
    "~0636320206 ~3433300001",              // 9
    "0000 0303",                            // :
    "000a 0303",                            // ;
    "340230",                               // <
    "0131 0333",                            // =
    "043200",                               // >
    "~0506363312 1010",                     // ?
    "~3213142433 ~3332424446260602002040",  // @
    "002640 1232",                          // A
    "0006 ~062636332303 ~032343402000",     // B
    "~454626060300204041",                  // C
    "0006 ~06264643402000",                 // D
    "40000646 0333",                        // E
    "000646 0333",                          // F
    "~45462606030020404243 4323",           // G
    "0006 4046 0343",                       // H
    "0006",                                 // I
    "~363230100001",                        // J
    "0006 4602 1340",                       // K
    "060040",                               // L
    "0006234640",                           // M
    "00064046",                             // N
    "~264643402000030626",                  // O
    "0006 ~062646432303",                   // P
    "~264643402000030626 2240",             // Q
    "0006 ~062646432303 2340",              // R
    "~45462606034340200001",                // S
    "0646 2026",                            // T
    "~06030020404346",                      // U
    "062046",                               // V
    "0610243046",                           // W
    "0640 0046",                            // X
    "062346 2320",                          // Y
    "06460040",                             // Z
    "16060010",                             // [
    "0630",                                 // backslash
    "06161000",                             // ]
    "042644",                               // ^
    "0a4a",                                 // _
    "0615",                                 // `
    "~0434300004 3430",                     // a
    "0600 ~0434300004",                     // b
    "~333404003031",                        // c
    "3630 ~0434300004",                     // d
    "0232 ~323404003031",                   // e
    "~36161310 0424",                       // f
    "~0434300004 ~34303b0b0a",              // g
    "0600 ~0204343230",                     // h
    "0400 0606",                            // i
    "~14101b0b 1616",                       // j
    "0600 3401 1230",                       // k
    "0600",                                 // l
    "0400 ~0204242220 ~2224444240",         // m
    "0400 ~0204343230",                     // n
    "~0434300004",                          // o
    "040b ~0434300004",                     // p
    "343b ~0434300004",                     // q
    "0400 ~020424",                         // r
    "~3334040232300001",                    // s
    "~16121020 0424",                       // t
    "~040200303234 3430",                   // u
    "042044",                               // v
    "0410233044",                           // w
    "0430 0034",                            // x
    "0420 441b",                            // y
    "04340030",                             // z
    "~2616140403 ~0302121020",              // {
    "0b06",                                 // |
    "~0616142423 ~2322121000",              // }
    "~0213223342",                          // ~
};
constexpr std::string_view kBox = "0006363000";
constexpr double kCapHeight = 6.0;      // grid units
constexpr double kSpacing = 2.0;        // between glyphs
constexpr double kSpaceWidth = 2.0;     // of a blank, beside the spacing
constexpr double kStrokeShare = 0.065;  // radius of the stroke to the height of a capital

using Polyline = std::vector<Pixel2>;

double grid_y(char c) { return c == 'a' ? -1.0 : c == 'b' ? -2.0 : static_cast<double>(c - '0'); }

/// Corner cutting, whose limit is the quadratic B-spline of the polygon; open ends stay.
Polyline cut_corners(const Polyline& line) {
  const bool is_closed = line.front().x == line.back().x && line.front().y == line.back().y;
  Polyline cut;
  if (!is_closed) {
    cut.push_back(line.front());
  }
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Pixel2 a = line[i];
    const Pixel2 b = line[i + 1];
    cut.push_back({0.75 * a.x + 0.25 * b.x, 0.75 * a.y + 0.25 * b.y});
    cut.push_back({0.25 * a.x + 0.75 * b.x, 0.25 * a.y + 0.75 * b.y});
  }
  cut.push_back(is_closed ? cut.front() : line.back());
  return cut;
}

Polyline stroke_of(std::string_view code) {
  constexpr int kSmoothingSteps = 4;
  const bool is_smooth = code.starts_with('~');
  code.remove_prefix(is_smooth ? 1 : 0);
  Polyline line;
  for (std::size_t i = 0; i + 1 < code.size(); i += 2) {
    line.push_back({static_cast<double>(code[i] - '0'), grid_y(code[i + 1])});
  }
  for (int step = 0; is_smooth && step < kSmoothingSteps; ++step) {
    line = cut_corners(line);
  }
  return line;
}

std::vector<Polyline> strokes_of(std::string_view glyph) {
  std::vector<Polyline> strokes;
  while (!glyph.empty()) {
    const std::size_t size = std::min(glyph.find(' '), glyph.size());
    strokes.push_back(stroke_of(glyph.substr(0, size)));
    glyph.remove_prefix(std::min(size + 1, glyph.size()));
  }
  return strokes;
}

double width_of(const std::vector<Polyline>& strokes) {
  double width = strokes.empty() ? kSpaceWidth : 0.0;
  for (const Polyline& stroke : strokes) {
    for (const Pixel2& point : stroke) {
      width = std::max(width, point.x);
    }
  }
  return width;
}

/// The glyphs of a text; one box for each character beyond ASCII, whatever its number of bytes.
std::vector<std::string_view> glyphs_of(std::string_view text) {
  std::vector<std::string_view> glyphs;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code >= 0x80 && code < 0xc0) {
      continue;  // goes on with the character before
    }
    const bool is_ascii = code >= ' ' && code <= '~';
    glyphs.push_back(is_ascii ? kGlyphs[static_cast<std::size_t>(code - ' ')] : kBox);
  }
  return glyphs;
}

}  // namespace

double text_width(std::string_view text, const TextStyle& style) {
  double width = 0.0;
  for (const std::string_view glyph : glyphs_of(text)) {
    width += width_of(strokes_of(glyph)) + kSpacing;
  }
  return std::max(0.0, width - kSpacing) * style.cap_height_px / kCapHeight;
}

double draw_text(Layer& layer, Pixel2 origin, std::string_view text, const TextStyle& style) {
  const double unit = style.cap_height_px / kCapHeight;
  const double radius = std::max(0.6, kStrokeShare * style.cap_height_px);
  double x = origin.x;
  for (const std::string_view glyph : glyphs_of(text)) {
    const std::vector<Polyline> strokes = strokes_of(glyph);
    for (const Polyline& stroke : strokes) {
      for (std::size_t i = 0; i + 1 < stroke.size(); ++i) {
        layer.stroke({x + unit * stroke[i].x, origin.y - unit * stroke[i].y},
                     {x + unit * stroke[i + 1].x, origin.y - unit * stroke[i + 1].y}, radius, style.colour);
      }
    }
    x += unit * (width_of(strokes) + kSpacing);
  }
  return x - unit * kSpacing;
}

}  // namespace gdtslam
