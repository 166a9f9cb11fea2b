// The legend of a plot, where it hides least.
#include <algorithm>
#include <limits>

#include "engine/drawing/letters.hpp"
#include "engine/drawing/plots/bars.hpp"
#include "gdtslam/drawing/plot.hpp"

namespace gdtslam {
namespace {

/// All of the text size.
constexpr double kRow = 1.6;
constexpr double kSwatch = 1.9;
constexpr double kPadding = 0.7;
constexpr double kFromFrame = 0.8;
constexpr double kSmallestShare = 0.7;  // of the plot's letters

}  // namespace

Point2 Plot::place_of_legend(double width, double height) const {
  const double margin = kFromFrame * look_.text_size;
  const double left = inside_.corner.x() + margin;
  const double right = inside_.corner.x() + inside_.width - margin - width;
  const double top = inside_.corner.y() + margin;
  const double bottom = inside_.corner.y() + inside_.height - margin - height;
  const double middle = 0.5 * (left + right);
  const double centre = 0.5 * (top + bottom);
  Point2 best(right, top);
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (const Point2& place :
       {Point2(right, top), Point2(left, top), Point2(right, bottom), Point2(left, bottom), Point2(middle, top),
        Point2(middle, bottom), Point2(right, centre), Point2(left, centre)}) {
    const auto hidden = static_cast<std::size_t>(std::count_if(covered_.begin(), covered_.end(), [&](const Point2& at) {
      return at.x() >= place.x() && at.x() <= place.x() + width && at.y() >= place.y() && at.y() <= place.y() + height;
    }));
    if (hidden >= fewest) continue;
    fewest = hidden;
    best = place;
  }
  return best;
}

void Plot::draw_entry(const Entry& entry, const Point2& at, double size) {
  const double letter_px = kTickLetters * size;
  const double swatch = kSwatch * size;
  const Point2 middle = at + Point2(0.5 * swatch, -0.36 * letter_px);
  switch (entry.mark) {
    case Mark::kLine:
      canvas_.line(middle - Point2(0.5 * swatch, 0.0), middle + Point2(0.5 * swatch, 0.0), entry.pen);
      break;
    case Mark::kDot:
      canvas_.circle(middle, 0.3 * size, entry.fill);
      break;
    case Mark::kArea:
      canvas_.rectangle(middle - Point2(0.5 * swatch, 0.4 * size), swatch, 0.8 * size, entry.fill);
      break;
  }
  canvas_.text(at + Point2(swatch + 0.6 * size, 0.0), entry.name, {.size = letter_px, .colour = look_.theme.text});
}

void Plot::legend() {
  if (entries_.empty()) return;
  double words = 0.0;
  for (const Entry& entry : entries_) words = std::max(words, text_width(entry.name, kTickLetters));
  const double wide = kSwatch + 0.6 + 2.0 * kPadding;
  // In a small picture smaller letters, and in the end fewer of them.
  const double room = std::max(1.0, inside_.width - 2.0 * kFromFrame * look_.text_size);
  const double size = look_.text_size * std::clamp(room / ((wide + words) * look_.text_size), kSmallestShare, 1.0);
  const double width = std::min(room, (wide + words) * size);
  for (Entry& entry : entries_) entry.name = shortened(entry.name, kTickLetters * size, width - wide * size + 1e-6);
  const double height = (kRow * static_cast<double>(entries_.size()) + kPadding) * size;
  const Point2 corner = place_of_legend(width, height);
  canvas_.rectangle(corner, width, height, Fill{look_.theme.card, 0.88}, Pen{.colour = look_.theme.edge}, 0.4 * size);
  Point2 at = corner + Point2(kPadding * size, (kPadding + 0.85) * size);
  for (const Entry& entry : entries_) {
    draw_entry(entry, at, size);
    at.y() += kRow * size;
  }
}

}  // namespace gdtslam
