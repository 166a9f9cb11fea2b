// Widths of words as Cairo draws them.
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "cairo_painter.hpp"
#include "engine/drawing/letters.hpp"
#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {
namespace {

constexpr double kMeasured_px = 1000.0;  ///< size of the letters that are measured; widths are proportional

/// A font may be used by all threads.
cairo_scaled_font_t* measured_font(bool is_bold) {
  static const CairoFont fonts[] = {scaled_font(false, kMeasured_px), scaled_font(true, kMeasured_px)};
  return fonts[is_bold ? 1 : 0].get();
}

}  // namespace

double text_width(std::string_view words, double size, bool is_bold) {
  cairo_text_extents_t extents;
  cairo_scaled_font_text_extents(measured_font(is_bold), legible(words).c_str(), &extents);
  return extents.x_advance * size / kMeasured_px;
}

std::string shortened(const std::string& words, double size, double room, bool is_bold) {
  if (text_width(words, size, is_bold) <= room) return words;
  const std::string dots = "\xE2\x80\xA6";
  std::string cut = words;
  while (!cut.empty() && text_width(cut + dots, size, is_bold) > room) {
    // A letter may take several bytes: those that continue it go with it.
    while (cut.size() > 1 && (static_cast<unsigned char>(cut.back()) & 0xC0U) == 0x80U) cut.pop_back();
    cut.pop_back();
  }
  return cut + dots;
}

std::string shortened_within(const std::string& words, double size, double room, std::size_t kept) {
  if (text_width(words, size) <= room) return words;
  std::string tail = words.substr(words.size() - std::min(kept, words.size()));
  const std::string name = words.substr(0, words.size() - tail.size());
  if (text_width(tail, size) > room * 2.0 / 3.0) tail.clear();
  std::vector<std::string_view> letters;
  for (std::size_t at = 0; at < name.size();) letters.push_back(next_letter(name, at).bytes);
  const auto with_letters = [&](std::size_t count) {
    std::string text;
    for (std::size_t k = 0; k < (count + 1) / 2; ++k) text += letters[k];
    if (count < letters.size()) text += "\xE2\x80\xA6";
    for (std::size_t k = letters.size() - count / 2; k < letters.size(); ++k) text += letters[k];
    return text + tail;
  };
  std::size_t fits = 0;  // so many do, or none can
  std::size_t least_beyond = letters.size() + 1;
  while (fits + 1 < least_beyond) {
    const std::size_t count = fits + (least_beyond - fits) / 2;
    (text_width(with_letters(count), size) <= room ? fits : least_beyond) = count;
  }
  return with_letters(fits);
}

}  // namespace gdtslam
