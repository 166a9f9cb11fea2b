#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/drawing/letters.hpp"
#include "engine/drawing/plots/bars.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/viewer/camera.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {
namespace {

// 20 px letters at 1080 rows; at least 11 below 600 rows, because smaller ones are illegible.
constexpr double kLetterShare = 1.0 / 54.0;
constexpr double kLeastLetter_px = 11.0;
constexpr double kMarginLetters = 1.5;
constexpr double kTitleLetters = 1.5;  // size of the title
constexpr double kNoteLetters = 0.85;  // size of remarks
constexpr double kTitleShare = 0.4;    // share of the picture's height, for title and subtitle
constexpr double kBarShare = 0.26;     // share of the picture's width, for the colour bar
constexpr double kShortestBarLetters = 5.0;
constexpr double kGroundOpacity = 0.75;  // opacity of the bar's background: the scene is visible through it
constexpr double kScaleBarShare = 0.16;  // share of the picture's width, at most
constexpr double kTriadLetters = 2.4;    // length of an axis
constexpr double kTriadShare = 0.35;     // share of the picture's height, at most
constexpr double kSeenEndOn = 0.25;      // an axis that appears shorter than this share is not drawn

// The background of a transparent picture is unknown: dark words with a light halo are legible on white and on dark.
Theme scene_theme(const CloudLook& look) {
  if (!look.is_transparent) return look.is_dark ? kDarkTheme : kLightTheme;
  Theme theme = kLightTheme;
  theme.quiet = theme.text;
  return theme;
}

/// Lays out words and bars over the picture of a cloud, in units of the letters' size, which follows the picture's
/// height. Parts are placed in turn; one without room is left out.
class CloudLayout {
 public:
  CloudLayout(Canvas& canvas, const CloudLook& look)
      : canvas_(canvas),
        theme_(scene_theme(look)),
        letter_(std::max(kLeastLetter_px, kLetterShare * std::min(canvas.height(), 0.75 * canvas.width()))),
        margin_(kMarginLetters * letter_),
        has_ground_(!look.is_transparent) {}

  void write_title(const CloudCaption& caption) {
    double base = margin_;
    const double most = canvas_.width() - 2.0 * margin_;
    for (const bool is_title : {true, false}) {
      const std::string& words = is_title ? caption.title : caption.subtitle;
      const double size = is_title ? kTitleLetters * letter_ : letter_;
      if (words.empty()) continue;
      const std::string fitting = shortened(words, size, most, is_title);
      if (text_width(fitting, size, is_title) > most || base + size > kTitleShare * canvas_.height()) continue;
      base += size;
      canvas_.text({margin_, base}, fitting, lettering(size, is_title ? theme_.text : theme_.quiet, is_title));
      take({{margin_, base - size}, text_width(fitting, size, is_title), 1.3 * size});
      base += 0.55 * letter_;
    }
  }
  /// Lower left; for a perspective camera it states the place in the picture where it is valid.
  void draw_scale_bar(const Camera& camera, const PictureSize& size) {
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
  // Lower right beside the scale bar, because a fitting scene is sparse there.
  void draw_colour_bar(const ColourScale& scale) {
    if (scale.quantity.empty()) return;
    ColourBar bar;
    bar.map = &colour_map(scale.colour_map);
    bar.from = scale.least;
    bar.to = scale.most;
    bar.title = scale.unit.empty() ? scale.quantity : fmt::format("{} ({})", scale.quantity, scale.unit);
    bar.steps = scale.unit == "°" ? TickSteps::kDegrees : TickSteps::kDecimal;
    bar.text_size = letter_;
    bar.thickness = 0.9 * letter_;
    bar.has_halo = true;
    for (bar.length = kBarShare * canvas_.width(); bar.length >= kShortestBarLetters * letter_; bar.length *= 0.85) {
      DrawingArea room = colour_bar_room(bar);
      room.corner = {canvas_.width() - margin_ - room.width, canvas_.height() - margin_ - room.height};
      if (!is_free(room)) continue;
      take(room);
      if (has_ground_) canvas_.rectangle(room.corner, room.width, room.height, Fill{theme_.page, kGroundOpacity});
      gdtslam::draw_colour_bar(canvas_, bar, room.corner, theme_);
      return;
    }
  }
  /// The map's axes, upper right.
  void draw_axes(const Camera& camera) {
    const double reach = (kTriadLetters + 1.4) * letter_;
    const Point2 centre(canvas_.width() - margin_ - reach, margin_ + reach);
    const DrawingArea room{centre - Point2(reach, reach), 2.0 * reach, 2.0 * reach};
    if (!is_free(room) || room.height > kTriadShare * canvas_.height()) return;
    take(room);
    const CameraBasis basis = camera_basis(camera);
    struct Axis {
      const char* name;
      Point3 direction;
      Colour colour;
    };
    std::array<Axis, 3> axes{{{"x", Point3::UnitX(), theme_.curve(1)},
                              {"y", Point3::UnitY(), theme_.curve(2)},
                              {"z", Point3::UnitZ(), theme_.curve(0)}}};
    // An axis that points away from the viewer is drawn first.
    std::stable_sort(axes.begin(), axes.end(), [&basis](const Axis& a, const Axis& b) {
      return a.direction.dot(basis.forward) > b.direction.dot(basis.forward);
    });
    for (const Axis& axis : axes) {
      const Point2 along(axis.direction.dot(basis.right), -axis.direction.dot(basis.up));
      if (along.norm() < kSeenEndOn) continue;
      const Point2 end = centre + kTriadLetters * letter_ * along;
      canvas_.line(centre, end, {.colour = theme_.page, .width = 0.34 * letter_, .opacity = 0.6});
      canvas_.line(centre, end, {.colour = axis.colour, .width = 0.14 * letter_});
      const Point2 letter = end + 0.75 * letter_ * along.normalized();
      canvas_.text({letter.x(), letter.y() + 0.32 * letter_}, axis.name,
                   lettering(0.95 * letter_, axis.colour, true, Anchor::kMiddle));
    }
    canvas_.circle(centre, 0.13 * letter_, Fill{.colour = theme_.quiet});
  }

 private:
  void take(const DrawingArea& area) { taken_.push_back(area); }
  [[nodiscard]] Lettering lettering(double size, Colour colour, bool is_bold = false,
                                    Anchor anchor = Anchor::kStart) const {
    return {
        .size = size, .colour = colour, .anchor = anchor, .is_bold = is_bold, .has_halo = true, .halo = theme_.page};
  }
  // Whether the area is inside the picture and half a letter away from parts already placed.
  [[nodiscard]] bool is_free(const DrawingArea& area) const {
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

  Canvas& canvas_;
  Theme theme_;
  double letter_;
  double margin_;
  bool has_ground_;
  std::vector<DrawingArea> taken_;
};

}  // namespace

Canvas cloud_picture(std::shared_ptr<const RgbaImage> scene, const ColourScale& scale, const Camera& camera,
                     const CloudLook& look, const CloudCaption& caption) {
  const PictureSize size{.width = scene->width, .height = scene->height};
  Canvas canvas(size.width, size.height, caption.title.empty() ? "Point cloud" : caption.title);
  canvas.picture({0.0, 0.0}, size.width, size.height, std::move(scene));
  CloudLayout layout(canvas, look);
  layout.write_title(caption);
  if (!caption.with_bars) return canvas;
  layout.draw_scale_bar(camera, size);
  layout.draw_colour_bar(scale);
  layout.draw_axes(camera);
  return canvas;
}

}  // namespace gdtslam
