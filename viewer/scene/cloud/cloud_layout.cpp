#include "cloud_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "viewer/scene/camera_basis.hpp"

namespace gdtslam {
namespace {

// At 1080 rows letters are 20 px high; below 600 rows 11, because smaller ones could not be read.
constexpr double kLetterShare = 1.0 / 54.0;
constexpr double kLeastLetter_px = 11.0;
constexpr double kMarginLetters = 1.5;
constexpr double kTitleLetters = 1.5;   // size of the title
constexpr double kNoteLetters = 0.85;   // size of remarks
constexpr double kTitleShare = 0.4;     // of the picture's height, for title and subtitle
constexpr double kUprightShare = 0.42;  // of the picture's height, of the colour bar
constexpr double kLyingShare = 0.26;    // of the picture's width, of the colour bar
constexpr double kShortestBarLetters = 5.0;
constexpr double kScaleBarShare = 0.16;  // of the picture's width, at most
constexpr double kTriadLetters = 2.4;    // length of an axis
constexpr double kTriadShare = 0.35;     // of the picture's height, at most
constexpr double kSeenEndOn = 0.12;      // an axis shorter than this share of its length says nothing
constexpr double kLettersApart = 1.15;   // middles of two axes' letters, in letters
constexpr double kLetterOffLine = 0.5;   // a letter's middle from another axis, in letters
constexpr int kClearStep = 10;           // by which a pixel of the scene differs from the page

bool is_lying(BarPlace place) { return place == BarPlace::kLyingRight || place == BarPlace::kLyingMiddle; }

// Nobody knows what a transparent picture will lie on: dark words with a light halo can be read on white and on dark.
Theme theme_of(const CloudLook& look) {
  if (!look.is_transparent) return look.is_dark ? kDarkTheme : kLightTheme;
  Theme theme = kLightTheme;
  theme.quiet = theme.text;
  return theme;
}

double distance_to_line(const Point2& at, const Point2& start, const Point2& end) {
  const Point2 along = end - start;
  const double share = std::clamp((at - start).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (at - start - share * along).norm();
}

// The words with as many letters as fit, three dots in place of the rest; nothing where not even four fit.
std::string shortened(const std::string& words, double size, bool is_bold, double most) {
  if (text_width(words, size, is_bold) <= most) return words;
  std::string begin = words;
  while (!begin.empty()) {
    // A letter of UTF-8 is taken away whole.
    while (!begin.empty() && (static_cast<unsigned char>(begin.back()) & 0xC0U) == 0x80U) begin.pop_back();
    if (!begin.empty()) begin.pop_back();
    if (begin.size() >= 4 && text_width(begin + "...", size, is_bold) <= most) return begin + "...";
  }
  return "";
}

}  // namespace

CloudLayout::CloudLayout(Canvas& canvas, const CloudLook& look)
    : canvas_(canvas),
      theme_(theme_of(look)),
      is_transparent_(look.is_transparent),
      letter_(std::max(kLeastLetter_px, kLetterShare * std::min(canvas.height(), 0.75 * canvas.width()))),
      margin_(kMarginLetters * letter_) {}

Lettering CloudLayout::lettering(double size, Colour colour, bool is_bold, Anchor anchor) const {
  return {.size = size, .colour = colour, .anchor = anchor, .is_bold = is_bold, .has_halo = true, .halo = theme_.page};
}

// Inside the picture, and half a letter away from what stands there already.
bool CloudLayout::is_free(const DrawingArea& area) const {
  const double gap = 0.5 * letter_;
  if (area.corner.x() < gap || area.corner.y() < gap) return false;
  if (area.corner.x() + area.width > canvas_.width() - gap) return false;
  if (area.corner.y() + area.height > canvas_.height() - gap) return false;
  return std::none_of(taken_.begin(), taken_.end(), [&](const DrawingArea& other) {
    return area.corner.x() < other.corner.x() + other.width + gap &&
           other.corner.x() < area.corner.x() + area.width + gap &&
           area.corner.y() < other.corner.y() + other.height + gap &&
           other.corner.y() < area.corner.y() + area.height + gap;
  });
}

double CloudLayout::covered_share(const DrawingArea& area, const RgbaImage& scene) const {
  const auto pixel = [](double at, std::uint32_t most) {
    return static_cast<std::uint32_t>(std::clamp(at, 0.0, static_cast<double>(most)));
  };
  const std::uint32_t left = pixel(area.corner.x(), scene.width);
  const std::uint32_t right = pixel(area.corner.x() + area.width, scene.width);
  const std::uint32_t top = pixel(area.corner.y(), scene.height);
  const std::uint32_t bottom = pixel(area.corner.y() + area.height, scene.height);
  std::size_t covered = 0;
  for (std::uint32_t y = top; y < bottom; ++y) {
    for (std::uint32_t x = left; x < right; ++x) {
      const std::uint8_t* at = scene.at(x, y);
      const bool is_clear = std::abs(at[0] - theme_.page.red) > kClearStep ||
                            std::abs(at[1] - theme_.page.green) > kClearStep ||
                            std::abs(at[2] - theme_.page.blue) > kClearStep;
      if (is_transparent_ ? at[3] > kClearStep : is_clear) ++covered;
    }
  }
  const double pixels = static_cast<double>(right - left) * static_cast<double>(bottom - top);
  return pixels > 0.0 ? static_cast<double>(covered) / pixels : 0.0;
}

void CloudLayout::write_title(const CloudCaption& caption) {
  double base = margin_;
  const double most = canvas_.width() - 2.0 * margin_;
  for (const bool is_title : {true, false}) {
    const std::string& words = is_title ? caption.title : caption.subtitle;
    const double size = is_title ? kTitleLetters * letter_ : letter_;
    if (words.empty()) continue;
    const std::string fitting = shortened(words, size, is_title, most);
    if (fitting.empty() || base + size > kTitleShare * canvas_.height()) continue;
    base += size;
    canvas_.text({margin_, base}, fitting, lettering(size, is_title ? theme_.text : theme_.quiet, is_title));
    take({{margin_, base - size}, text_width(fitting, size, is_title), 1.3 * size});
    base += 0.55 * letter_;
  }
}

void CloudLayout::draw_scale_bar(const Camera& camera, const PictureSize& size) {
  const double scale_px = pixels_per_metre(camera, size, camera.target);
  if (!(scale_px > 0.0)) return;
  const ScaleBar bar{.pixels_per_m = scale_px, .most = kScaleBarShare * canvas_.width(), .text_size = letter_};
  const double length_px = round_length_m(bar.most / scale_px) * scale_px;
  if (length_px < 2.0 * letter_) return;
  const std::string note = camera.is_parallel ? "" : "at the centre";
  const double note_size = kNoteLetters * letter_;
  const double note_width = note.empty() ? 0.0 : text_width(note, note_size) + 0.8 * letter_;
  const Point2 start(margin_, canvas_.height() - margin_ - 0.3 * letter_);
  const DrawingArea room{{start.x(), start.y() - 2.0 * letter_}, length_px + note_width, 2.4 * letter_};
  if (!is_free(room)) return;
  take(room);
  gdtslam::draw_scale_bar(canvas_, bar, start, theme_);
  if (note.empty()) return;
  canvas_.text({start.x() + length_px + 0.8 * letter_, start.y() + 0.35 * note_size}, note,
               lettering(note_size, theme_.quiet));
}

Point2 CloudLayout::bar_corner(const DrawingArea& room, BarPlace place) const {
  Point2 low_right(canvas_.width() - margin_ - room.width, canvas_.height() - margin_ - room.height);
  switch (place) {
    case BarPlace::kMiddleRight:
      return {low_right.x(), 0.5 * (canvas_.height() - room.height)};
    case BarPlace::kLyingMiddle:
      return {0.5 * (canvas_.width() - room.width), low_right.y()};
    case BarPlace::kLeft:
      return {margin_, low_right.y() - 3.5 * letter_};
    case BarPlace::kLowRight:
    case BarPlace::kLyingRight:
      break;
  }
  return low_right;
}

std::optional<CloudLayout::PlacedBar> CloudLayout::placed_bar(const ColourScale& scale, BarPlace place) const {
  if (scale.quantity.empty()) return std::nullopt;
  ColourBar bar;
  bar.map = &colour_map(scale.colour_map);
  bar.from = scale.least;
  bar.to = scale.most;
  bar.title = scale.unit.empty() ? scale.quantity : fmt::format("{} ({})", scale.quantity, scale.unit);
  bar.is_upright = !is_lying(place);
  bar.steps = scale.unit == "°" ? TickSteps::kDegrees : TickSteps::kDecimal;
  bar.text_size = letter_;
  bar.thickness = 0.9 * letter_;
  bar.has_halo = true;
  bar.length = bar.is_upright ? kUprightShare * canvas_.height() : kLyingShare * canvas_.width();
  for (; bar.length >= kShortestBarLetters * letter_; bar.length *= 0.85) {
    DrawingArea room = room_of(bar);
    room.corner = bar_corner(room, place);
    if (is_free(room)) return PlacedBar{.bar = bar, .room = room};
  }
  return std::nullopt;
}

std::optional<BarPlace> CloudLayout::best_bar_place(const ColourScale& scale, const RgbaImage& scene) const {
  std::optional<BarPlace> best;
  double least = 2.0;
  for (const BarPlace place :
       {BarPlace::kLowRight, BarPlace::kMiddleRight, BarPlace::kLyingRight, BarPlace::kLyingMiddle, BarPlace::kLeft}) {
    const auto placed = placed_bar(scale, place);
    if (!placed) continue;
    const double share = covered_share(placed->room, scene);
    if (share >= least) continue;
    least = share;
    best = place;
  }
  return best;
}

void CloudLayout::draw_colour_bar(const ColourScale& scale, BarPlace place) {
  const auto placed = placed_bar(scale, place);
  if (!placed) return;
  take(placed->room);
  gdtslam::draw_colour_bar(canvas_, placed->bar, placed->room.corner, theme_);
}

// Farthest from the middle first; a letter that would come near another, or upon another axis, stands beside its
// axis' end, and where that does not help either, is left out: the axis points to the viewer or away.
void CloudLayout::draw_axis_letters(const Point2& centre, std::span<const Axis> axes) {
  std::vector<const Axis*> longest_first;
  for (const Axis& axis : axes) {
    if (axis.along.norm() >= kSeenEndOn) longest_first.push_back(&axis);
  }
  std::stable_sort(longest_first.begin(), longest_first.end(),
                   [](const Axis* a, const Axis* b) { return a->along.norm() > b->along.norm(); });
  std::vector<Point2> taken;
  const double length = kTriadLetters * letter_;
  for (const Axis* axis : longest_first) {
    const auto is_clear = [&](const Point2& at) {
      return std::none_of(taken.begin(), taken.end(),
                          [&](const Point2& other) { return (at - other).norm() < kLettersApart * letter_; }) &&
             std::none_of(longest_first.begin(), longest_first.end(), [&](const Axis* other) {
               return other != axis &&
                      distance_to_line(at, centre, centre + length * other->along) < kLetterOffLine * letter_;
             });
    };
    const Point2 ahead = axis->along.normalized();
    const Point2 beside(-ahead.y(), ahead.x());
    const Point2 end = centre + length * axis->along;
    for (const Point2& by : {ahead, beside, Point2(-beside)}) {
      const Point2 at = end + 0.75 * letter_ * by;
      if (!is_clear(at)) continue;
      taken.push_back(at);
      canvas_.text({at.x(), at.y() + 0.32 * letter_}, axis->name,
                   lettering(0.95 * letter_, axis->colour, true, Anchor::kMiddle));
      break;
    }
  }
}

void CloudLayout::draw_axes(const Camera& camera) {
  const double reach = (kTriadLetters + 1.4) * letter_;
  const Point2 centre(canvas_.width() - margin_ - reach, margin_ + reach);
  const DrawingArea room{centre - Point2(reach, reach), 2.0 * reach, 2.0 * reach};
  if (!is_free(room) || room.height > kTriadShare * canvas_.height()) return;
  take(room);
  const CameraBasis basis = basis_of(camera);
  std::array<Axis, 3> axes{{{"x", Point3::UnitX(), theme_.curve(1)},
                            {"y", Point3::UnitY(), theme_.curve(2)},
                            {"z", Point3::UnitZ(), theme_.curve(0)}}};
  // What points away from the viewer is drawn first.
  std::stable_sort(axes.begin(), axes.end(), [&basis](const Axis& a, const Axis& b) {
    return a.direction.dot(basis.forward) > b.direction.dot(basis.forward);
  });
  for (Axis& axis : axes) {
    axis.along = {axis.direction.dot(basis.right), -axis.direction.dot(basis.up)};
    if (axis.along.norm() < kSeenEndOn) continue;
    const Point2 end = centre + kTriadLetters * letter_ * axis.along;
    canvas_.line(centre, end, {.colour = theme_.page, .width = 0.34 * letter_, .opacity = 0.6});
    canvas_.line(centre, end, {.colour = axis.colour, .width = 0.14 * letter_});
  }
  draw_axis_letters(centre, axes);
  canvas_.circle(centre, 0.13 * letter_, Fill{.colour = theme_.quiet});
}

// The words and bars over the picture of a cloud, in the order of need: the first to come finds room.
std::optional<BarPlace> bar_place_of(const RgbaImage& scene, const ColourScale& scale, const Camera& camera,
                                     const CloudLook& look, const CloudCaption& caption) {
  Canvas canvas(scene.width, scene.height, "");
  CloudLayout layout(canvas, look);
  layout.write_title(caption);
  if (caption.with_scale_bar) layout.draw_scale_bar(camera, {.width = scene.width, .height = scene.height});
  return layout.best_bar_place(scale, scene);
}

Canvas cloud_picture_at(std::optional<BarPlace> place, std::shared_ptr<const RgbaImage> scene, const ColourScale& scale,
                        const Camera& camera, const CloudLook& look, const CloudCaption& caption) {
  const RgbaImage& image = *scene;  // the canvas keeps it
  const PictureSize size{.width = image.width, .height = image.height};
  Canvas canvas(size.width, size.height, caption.title.empty() ? "Point cloud" : caption.title);
  canvas.picture({0.0, 0.0}, size.width, size.height, std::move(scene));
  CloudLayout layout(canvas, look);
  layout.write_title(caption);
  if (caption.with_scale_bar) layout.draw_scale_bar(camera, size);
  if (caption.with_colour_bar) {
    const std::optional<BarPlace> at = place ? place : layout.best_bar_place(scale, image);
    if (at) layout.draw_colour_bar(scale, *at);
  }
  if (caption.with_axes) layout.draw_axes(camera);
  return canvas;
}

Canvas cloud_picture(std::shared_ptr<const RgbaImage> scene, const ColourScale& scale, const Camera& camera,
                     const CloudLook& look, const CloudCaption& caption) {
  return cloud_picture_at(std::nullopt, std::move(scene), scale, camera, look, caption);
}

}  // namespace gdtslam
