// The frame of a plot: room for its words, ticks, grid, titles; and its legend, placed where it hides least.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/drawing/letters.hpp"
#include "engine/drawing/plots/bars.hpp"
#include "gdtslam/drawing/plot.hpp"

namespace gdtslam {
namespace {

constexpr int kMostTicks = 10;

/// Makes a range finite and not empty.
void mend(Axis& axis) {
  if (!std::isfinite(axis.from) || !std::isfinite(axis.to)) {
    axis.from = 0.0;
    axis.to = 1.0;
  }
  if (axis.from > axis.to) std::swap(axis.from, axis.to);
  // A range of rounding errors would have equal labels at all ticks.
  const double least = 1e-9 * std::max(std::fabs(axis.from), std::fabs(axis.to));
  if (axis.to - axis.from > least) return;
  const double half = axis.from == 0.0 ? 0.5 : 0.05 * std::fabs(axis.from);
  axis.from -= half;
  axis.to += half;
}

Ticks ticks_for(Axis& axis, int most) {
  if (!axis.is_grown || !axis.names.empty()) return make_ticks(axis.from, axis.to, most, axis.steps);
  const Ticks ticks = ticks_around(axis.from, axis.to, most, axis.steps);
  axis.from = ticks.value(0);
  axis.to = ticks.value(ticks.count - 1);
  return ticks;
}

/// Drops labels that would overlap the label before them.
template <class Label, class Place, class Size>
void keep_apart(std::vector<Label>& labels, const Place& place_of, const Size& size_of) {
  std::vector<Label> kept;
  for (Label& label : labels) {
    const bool fits = kept.empty() || std::fabs(place_of(label) - place_of(kept.back())) >=
                                          0.5 * (size_of(label) + size_of(kept.back()));
    if (fits) kept.push_back(std::move(label));
  }
  labels = std::move(kept);
}

/// The middle of a pixel, which keeps thin lines sharp.
double sharp(double pixel) { return std::floor(pixel) + 0.5; }

/// In text sizes:
constexpr double kRow = 1.6;
constexpr double kSwatch = 1.9;
constexpr double kPadding = 0.7;
constexpr double kFromFrame = 0.8;
constexpr double kSmallestShare = 0.7;  // least size of the legend's letters, in sizes of the plot's

}  // namespace

Plot::Plot(Canvas& canvas, const DrawingArea& area, Axis x, Axis y, PlotLook look)
    : canvas_(canvas), area_(area), x_(std::move(x)), y_(std::move(y)), look_(std::move(look)) {
  mend(x_);
  mend(y_);
  lay_out_y();
  lay_out_x();
  draw_axes();
}

double Plot::letters() const { return kTickLetters * look_.text_size; }

std::vector<Plot::Label> Plot::make_labels(const Axis& axis, const Ticks& ticks) {
  std::vector<Label> labels;
  for (std::size_t i = 0; i < axis.names.size(); ++i) {
    const std::string remark = i < axis.remarks.size() ? axis.remarks[i] : std::string();
    labels.push_back({axis.names[i].first, axis.names[i].second + remark, remark.size()});
  }
  if (!axis.names.empty()) return labels;
  for (int i = 0; i < ticks.count; ++i) labels.push_back({ticks.value(i), ticks.text(i), 0});
  return labels;
}

double Plot::widest(const std::vector<Label>& labels) const {
  double width = 0.0;
  for (const Label& label : labels) width = std::max(width, text_width(label.text, letters()));
  return width;
}

void Plot::lay_out_y() {
  const double size = look_.text_size;
  const double above = look_.title.empty() ? 0.7 * size : 2.2 * size;
  const double below = 1.8 * size + (x_.title.empty() ? 0.0 : 1.6 * size);
  inside_.height = std::max(1.0, area_.height - above - below);
  const int most = static_cast<int>(std::clamp(inside_.height / (2.6 * size), 1.0, 1.0 * kMostTicks));
  y_labels_ = make_labels(y_, ticks_for(y_, most));
  keep_apart(
      y_labels_, [&](const Label& label) { return at(0.0, label.value).y(); }, [&](const Label&) { return size; });
  const double left = widest(y_labels_) + kTick_px + 0.5 * size + (y_.title.empty() ? 0.0 : 1.7 * size);
  inside_.corner = area_.corner + Point2(left, above);
  inside_.width = std::max(1.0, area_.width - left);
}

void Plot::lay_out_x() {
  const double size = look_.text_size;
  const double room = inside_.width;
  const Axis asked = x_;
  for (int most = kMostTicks; most >= 1; --most) {
    x_ = asked;
    x_labels_ = make_labels(x_, ticks_for(x_, most));
    // Half of the last label is beyond the frame.
    const double half = x_labels_.empty() ? 0.0 : 0.5 * text_width(x_labels_.back().text, letters());
    inside_.width = std::max(1.0, room - (x_.names.empty() ? std::max(0.7 * size, half) : 0.7 * size));
    if (!x_.names.empty() || label_distance() >= widest(x_labels_) + size) break;
  }
  const double distance = label_distance();
  if (x_.names.empty()) {
    keep_apart(
        x_labels_, [&](const Label& label) { return at(label.value, 0.0).x(); },
        [&](const Label& label) { return text_width(label.text, letters()) + 0.6 * size; });
    return;
  }
  if (widest(x_labels_) + 0.6 * size > distance) fit_names(distance);
}

void Plot::fit_names(double distance) {
  const double size = look_.text_size;
  label_rows_ = 2;
  inside_.height = std::max(1.0, inside_.height - 1.3 * size);
  for (Label& label : x_labels_) {
    const double x = at(label.value, 0.0).x();
    const double to_edge = std::min(x - area_.corner.x(), area_.corner.x() + area_.width - x);
    label.text =
        shortened_within(label.text, letters(), std::min(2.0 * distance - 0.6 * size, 2.0 * to_edge), label.kept);
  }
}

double Plot::label_distance() const {
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < x_labels_.size(); ++i) {
    distance = std::min(distance, std::fabs(at(x_labels_[i].value, 0.0).x() - at(x_labels_[i - 1].value, 0.0).x()));
  }
  return std::min(distance, inside_.width);
}

Point2 Plot::at(double x, double y) const {
  return inside_.corner +
         Point2(inside_.width * (x - x_.from) / (x_.to - x_.from), inside_.height * (y_.to - y) / (y_.to - y_.from));
}

void Plot::draw_axes() {
  draw_y_axis();
  draw_x_axis();
  const Point2 far = inside_.corner + Point2(inside_.width, inside_.height);
  const Point2 near(sharp(inside_.corner.x()), sharp(inside_.corner.y()));
  const Pen pen{.colour = look_.theme.quiet, .width = 1.0, .opacity = 0.7};
  if (look_.has_frame) {
    canvas_.rectangle(near, sharp(far.x()) - near.x(), sharp(far.y()) - near.y(), std::nullopt, pen);
  } else {
    canvas_.polyline({near, {near.x(), sharp(far.y())}, {sharp(far.x()), sharp(far.y())}}, pen);
  }
  draw_titles();
}

void Plot::draw_x_axis() {
  const double lower = inside_.corner.y() + inside_.height;
  for (std::size_t i = 0; i < x_labels_.size(); ++i) {
    const double x = sharp(at(x_labels_[i].value, 0.0).x());
    if (x_.has_grid && x_.names.empty()) {
      canvas_.line({x, inside_.corner.y()}, {x, lower}, {.colour = look_.theme.grid});
    }
    canvas_.line({x, lower}, {x, lower + kTick_px}, {.colour = look_.theme.quiet, .opacity = 0.7});
    const double row = label_rows_ == 2 && i % 2 == 1 ? 1.3 * look_.text_size : 0.0;
    canvas_.text({x, lower + kTick_px + 1.15 * letters() + row}, x_labels_[i].text,
                 {.size = letters(), .colour = look_.theme.quiet, .anchor = Anchor::kMiddle});
  }
}

void Plot::draw_y_axis() {
  const double left = inside_.corner.x();
  for (const Label& label : y_labels_) {
    const double y = sharp(at(0.0, label.value).y());
    if (y_.has_grid && y_.names.empty()) {
      canvas_.line({left, y}, {left + inside_.width, y}, {.colour = look_.theme.grid});
    }
    canvas_.line({left - kTick_px, y}, {left, y}, {.colour = look_.theme.quiet, .opacity = 0.7});
    canvas_.text({left - kTick_px - 0.35 * look_.text_size, y + kHalfFigure * letters()}, label.text,
                 {.size = letters(), .colour = look_.theme.quiet, .anchor = Anchor::kEnd});
  }
}

void Plot::draw_titles() {
  const double size = look_.text_size;
  const Point2 middle = inside_.corner + 0.5 * Point2(inside_.width, inside_.height);
  const Lettering words{.size = size, .colour = look_.theme.text, .anchor = Anchor::kMiddle};
  if (!x_.title.empty()) canvas_.text({middle.x(), area_.corner.y() + area_.height - 0.35 * size}, x_.title, words);
  if (!y_.title.empty()) canvas_.upright_text({area_.corner.x() + size, middle.y()}, y_.title, words);
  if (look_.title.empty()) return;
  canvas_.text({inside_.corner.x(), area_.corner.y() + 1.15 * size}, look_.title,
               {.size = 1.1 * size, .colour = look_.theme.text, .is_bold = true});
}

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
  // A small picture has smaller letters, and then fewer entries.
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
