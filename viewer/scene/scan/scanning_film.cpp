// The film of the scanning mount on the robot.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/linkage/linkage_cycle.hpp"
#include "engine/core/elementary.hpp"
#include "engine/drawing/plots/bars.hpp"
#include "engine/drawing/plots/linkage_drawing.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/plot.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"
#include "gdtslam/viewer/linkage_scene.hpp"
#include "scanning_scene.hpp"
#include "scanning_track.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastText = 10.5;
constexpr double kTextShare = 0.0182;  ///< share of the picture's height
constexpr double kWindow_s = 24.0;     ///< length of the running plot if the film is longer
constexpr double kCardOpacity = 0.92;
constexpr int kCurveSteps = 600;
constexpr double kLeastWidth = 420.0;
constexpr double kLeastHeight = 280.0;

/// State at one moment of the film.
struct ScanningMoment {
  double stamp_s = 0.0;
  double elevation_rad = 0.0;
  double crank_rad = 0.0;
  std::uint64_t points = 0;
};

/// Overlay of the film: title, current figures, running elevation, close view of the mount. Sizes follow one text size.
class ScanningOverlay {
 public:
  /// Its times are relative to `zero_s`.
  ScanningOverlay(const ScanningTrack& track, double zero_s, const CloudLook& look, const CloudCaption& caption,
                  const PictureSize& size)
      : track_(track),
        zero_s_(zero_s),
        look_(look),
        caption_(caption),
        size_(size),
        theme_(look.is_dark ? kDarkTheme : kLightTheme),
        text_(std::max(kLeastText, kTextShare * std::min<double>(size.height, 0.75 * size.width))) {
    lowest_deg_ = std::numeric_limits<double>::max();
    highest_deg_ = std::numeric_limits<double>::lowest();
    for (const CloudPoint& point : track.points()) {
      const double elevation_deg = deg_from_rad(static_cast<double>(point.elevation_rad));
      lowest_deg_ = std::min(lowest_deg_, elevation_deg);
      highest_deg_ = std::max(highest_deg_, elevation_deg);
    }
    const double margin_deg = std::max(0.06 * (highest_deg_ - lowest_deg_), 0.5);
    lowest_deg_ -= margin_deg;
    highest_deg_ += margin_deg;
    if (size.width < kLeastWidth || size.height < kLeastHeight) return;
    const double margin = std::round(1.4 * text_);
    const double height = std::round(std::max(0.24 * std::min<double>(size.height, 0.75 * size.width), 11.0 * text_));
    const double wide = std::round(std::clamp(0.36 * size.width, 20.0 * text_, 46.0 * text_));
    plot_ = {{margin, size.height - margin - height}, std::min(wide, std::round(0.37 * size.width)), height};
    const double inset_width = std::round(std::min(1.25 * 1.4 * height, size.width - plot_.width - 3.0 * margin));
    const double inset_height = std::round(1.4 * height);
    inset_ = {{size.width - margin - inset_width, size.height - margin - inset_height}, inset_width, inset_height};
  }

  /// Area of the close view of the mount; without width if the picture is too small for one.
  [[nodiscard]] const DrawingArea& inset() const { return inset_; }
  void draw(Canvas& canvas, const ScanningMoment& moment, const ColourScale& scale,
            const std::shared_ptr<const RgbaImage>& mount) const {
    draw_title(canvas);
    if (plot_.width <= 0.0) return;
    draw_figures(canvas, moment, scale);
    draw_plot(canvas, moment);
    if (mount) draw_inset(canvas, moment, mount);
  }

 private:
  void draw_title(Canvas& canvas) const {
    const Point2 at(1.6 * text_, 2.9 * text_);
    canvas.text(at, caption_.title,
                {.size = 1.9 * text_, .colour = theme_.text, .is_bold = true, .has_halo = true, .halo = theme_.page});
    canvas.text(at + Point2(0.0, 1.8 * text_), caption_.subtitle,
                {.size = 1.05 * text_, .colour = theme_.text, .has_halo = true, .halo = theme_.page});
  }

  void draw_figures(Canvas& canvas, const ScanningMoment& moment, const ColourScale& scale) const {
    const bool has_bar = caption_.with_bars && look_.colour != CloudColour::kPlain;
    const double margin = std::round(1.4 * text_);
    const double width = std::round(19.0 * text_);
    const DrawingArea card{{size_.width - margin - width, margin}, width, std::round((has_bar ? 7.2 : 2.9) * text_)};
    draw_card(canvas, card);
    const Point2 left = card.corner + Point2(1.1 * text_, 1.9 * text_);
    const std::string points = with_commas(moment.points);
    canvas.text(left, points, {.size = 1.35 * text_, .colour = theme_.text, .is_bold = true});
    canvas.text(left + Point2(text_width(points, 1.35 * text_, true) + 0.5 * text_, 0.0), "points",
                {.size = text_, .colour = theme_.quiet});
    canvas.text(card.corner + Point2(width - 1.1 * text_, 1.9 * text_),
                fmt::format("{:.1f} s", moment.stamp_s - zero_s_),
                {.size = 1.1 * text_, .colour = theme_.text, .anchor = Anchor::kEnd});
    if (!has_bar) return;
    ColourBar bar;
    bar.map = &colour_map(scale.colour_map);
    bar.from = scale.least;
    bar.to = scale.most;
    bar.title = scale.unit.empty() ? scale.quantity : scale.quantity + " (" + scale.unit + ")";
    bar.length = width - 3.4 * text_;
    bar.thickness = 0.8 * text_;
    bar.text_size = 0.95 * text_;
    const DrawingArea room = colour_bar_room(bar);
    draw_colour_bar(canvas, bar, card.corner + Point2(0.5 * (width - room.width), 2.7 * text_), theme_);
  }

  void draw_plot(Canvas& canvas, const ScanningMoment& moment) const {
    draw_card(canvas, plot_);
    const std::string value = degrees_text(moment.elevation_rad) + "°";
    canvas.text(plot_.corner + Point2(plot_.width - 1.1 * text_, 1.75 * text_), value,
                {.size = 1.45 * text_,
                 .colour = look_.is_dark ? theme_.curve(4) : ink::kLaserText,
                 .anchor = Anchor::kEnd,
                 .is_bold = true});
    const double room = plot_.width - 3.2 * text_ - text_width("−000.0°", 1.45 * text_, true);
    const auto fits = [&](const char* words) { return text_width(words, 1.05 * text_, true) <= room; };
    const char* whole = "Elevation θ* (°) over time (s)";
    const char* heading = fits(whole) ? whole : (fits("Elevation θ*") ? "Elevation θ*" : "θ*");
    canvas.text(plot_.corner + Point2(1.1 * text_, 1.65 * text_), heading,
                {.size = 1.05 * text_, .colour = theme_.text, .is_bold = true});
    const double length_s = std::min(track_.to_s() - track_.from_s(), kWindow_s);
    // The current time stays at four fifths of a moving window.
    const double from_s = std::clamp(moment.stamp_s - 0.8 * length_s, track_.from_s(), track_.to_s() - length_s);
    Axis x;
    x.from = from_s - zero_s_;
    x.to = x.from + length_s;
    x.has_grid = false;
    Axis y;
    y.from = lowest_deg_;
    y.to = highest_deg_;
    y.steps = TickSteps::kDegrees;
    PlotLook plot_look;
    plot_look.text_size = 0.92 * text_;
    plot_look.theme = theme_;
    plot_look.has_frame = false;
    Plot plot(canvas,
              {plot_.corner + Point2(0.8 * text_, 1.8 * text_), plot_.width - 1.6 * text_, plot_.height - 2.3 * text_},
              x, y, plot_look);
    std::vector<Point2> curve;
    for (int i = 0; i <= kCurveSteps; ++i) {
      const double stamp_s = std::min(from_s + length_s * i / kCurveSteps, moment.stamp_s);
      curve.emplace_back(stamp_s - zero_s_, deg_from_rad(track_.elevation_rad(stamp_s)));
      if (stamp_s >= moment.stamp_s) break;
    }
    const Colour colour = look_.is_dark ? theme_.curve(4) : ink::kLaser;
    plot.line(curve, {.colour = colour, .width = 0.18 * text_});
    canvas.circle(plot.at(curve.back().x(), curve.back().y()), 0.42 * text_, Fill{.colour = colour},
                  Pen{.colour = theme_.card, .width = 0.14 * text_});
  }

  void draw_inset(Canvas& canvas, const ScanningMoment& moment, const std::shared_ptr<const RgbaImage>& mount) const {
    draw_card(canvas, inset_);
    canvas.picture(inset_.corner + Point2(1.0, 1.0), inset_.width - 2.0, inset_.height - 2.0, mount);
    const double crank_deg = deg_from_rad(moment.crank_rad);
    const std::string value = fmt::format("{:.0f}°", crank_deg - 360.0 * std::floor(crank_deg / 360.0));
    canvas.text(inset_.corner + Point2(1.1 * text_, 1.65 * text_), "The mount",
                {.size = 1.05 * text_, .colour = theme_.text, .is_bold = true});
    canvas.text(inset_.corner + Point2(inset_.width - 1.1 * text_, 1.75 * text_), value,
                {.size = 1.3 * text_, .colour = theme_.curve(1), .anchor = Anchor::kEnd, .is_bold = true});
    canvas.text(inset_.corner + Point2(inset_.width - 1.6 * text_ - text_width(value, 1.3 * text_, true), 1.75 * text_),
                "crank", {.size = 0.95 * text_, .colour = theme_.quiet, .anchor = Anchor::kEnd});
  }

  void draw_card(Canvas& canvas, const DrawingArea& area) const {
    canvas.rectangle(area.corner, area.width, area.height, Fill{.colour = theme_.card, .opacity = kCardOpacity},
                     Pen{.colour = theme_.edge}, 9.0);
  }

  const ScanningTrack& track_;
  double zero_s_;
  CloudLook look_;
  CloudCaption caption_;
  PictureSize size_;
  Theme theme_;
  double text_;
  DrawingArea plot_;
  DrawingArea inset_;
  double lowest_deg_ = 0.0;
  double highest_deg_ = 1.0;
};

constexpr double kLeastDistance_m = 1.7;
constexpr double kMostDistance_m = 4.5;
constexpr double kDistanceShare = 0.55;  ///< share of the usual range
constexpr double kSway_rad = 0.14;       ///< turn of the camera to each side, which gives depth while the robot stands
constexpr double kScanViewAngle_rad = 0.95;

/// Above and behind the robot on its right side, where the linkage is.
Camera camera_beside(const Pose2& T_map_base, double distance_m, double sway_rad) {
  const Pose2 looking{T_map_base.x_m, T_map_base.y_m, T_map_base.theta_rad + sway_rad};
  const Point2 eye = looking * Point2(-0.80 * distance_m, -0.62 * distance_m);
  const Point2 target = looking * Point2(0.28 * distance_m, 0.06 * distance_m);
  Camera camera;
  camera.eye = {eye.x(), eye.y(), 0.32 + 0.37 * distance_m};
  camera.target = {target.x(), target.y(), 0.42};
  camera.view_angle_rad = kScanViewAngle_rad;
  return camera;
}

class ScanningFilm : public Film {
 public:
  ScanningFilm(const GraphicsContext& graphics, const ScanningFilmInput& input, const CloudLook& look,
               const CloudCaption& caption, const PictureSize& size, std::size_t frames)
      : model_(*input.model),
        size_(size),
        frames_(frames),
        track_(*input.cloud, *input.trajectory, input.from_s, input.to_s),
        scene_(graphics, track_, model_, input.has_linkage, *input.trajectory, look),
        overlay_(track_, input.zero_s.value_or(input.from_s), look, caption, size),
        distance_m_(std::clamp(kDistanceShare * track_.usual_range_m(), kLeastDistance_m, kMostDistance_m)) {
    if (!input.has_linkage) return;
    cycle_.emplace(model_);
    if (overlay_.inset().width <= 0.0) return;
    const LinkageLook close{.is_dark = look.is_dark, .is_transparent = true, .with_panel = false, .samples = 2};
    mount_ = std::make_unique<LinkageScene>(graphics, model_, close);
  }

  [[nodiscard]] std::size_t frames() const override { return frames_; }

  Canvas frame(std::size_t k) override {
    const double share = frames_ > 1 ? static_cast<double>(k) / static_cast<double>(frames_ - 1) : 1.0;
    // The last frame's time equals the range's end to the bit, so that nothing is missing.
    const double stamp_s =
        k + 1 == frames_ ? track_.to_s() : track_.from_s() + share * (track_.to_s() - track_.from_s());
    ScanningMoment moment{.stamp_s = stamp_s, .elevation_rad = track_.elevation_rad(stamp_s)};
    if (cycle_) {
      moment.crank_rad = cycle_->crank_of(moment.elevation_rad, track_.is_rising(stamp_s), model_.encoder.direction);
    }
    scene_.show(stamp_s, moment.crank_rad);
    moment.points = scene_.points_drawn();
    const Camera camera =
        camera_beside(track_.T_map_base_smooth(stamp_s), distance_m_, kSway_rad * sin_cos(kTwoPi * share).sin);
    Canvas canvas(size_.width, size_.height, "A robot with a nodding laser, scanning");
    canvas.picture(Point2::Zero(), size_.width, size_.height,
                   std::make_shared<const RgbaImage>(scene_.render(camera, size_)));
    overlay_.draw(canvas, moment, scene_.scale(), mount_picture(moment.crank_rad));
    return canvas;
  }

 private:
  std::shared_ptr<const RgbaImage> mount_picture(double crank_rad) {
    if (!mount_) return nullptr;
    const PictureSize size{static_cast<std::uint32_t>(overlay_.inset().width) - 2,
                           static_cast<std::uint32_t>(overlay_.inset().height) - 2};
    return std::make_shared<const RgbaImage>(mount_->render(crank_rad, size));
  }

  calib::SweepModel model_;
  PictureSize size_;
  std::size_t frames_;
  ScanningTrack track_;
  std::optional<calib::LinkageCycle> cycle_;
  ScanningScene scene_;
  ScanningOverlay overlay_;
  double distance_m_;
  std::unique_ptr<LinkageScene> mount_;
};

}  // namespace

std::unique_ptr<Film> scanning_film(const GraphicsContext& graphics, const ScanningFilmInput& input,
                                    const CloudLook& look, const CloudCaption& caption, const PictureSize& size,
                                    std::size_t frames) {
  return std::make_unique<ScanningFilm>(graphics, input, look, caption, size, frames);
}

}  // namespace gdtslam
