// Where words and bars stand over the picture of a cloud. Everything is laid out in units of the letters' size, which
// follows the picture's height; what finds no room is left out. One object belongs to one picture.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/drawing/plots/bars.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {

/// Places of the colour bar, in the order of preference.
enum class BarPlace : std::uint8_t { kLowRight, kMiddleRight, kLyingRight, kLyingMiddle, kLeft };

class CloudLayout {
 public:
  CloudLayout(Canvas& canvas, const CloudLook& look);

  void write_title(const CloudCaption& caption);
  /// Lower left; where a perspective camera's picture has that scale is said beside it.
  void draw_scale_bar(const Camera& camera, const PictureSize& size);
  /// At the place where it covers least of the scene; of equal ones at the first.
  [[nodiscard]] std::optional<BarPlace> best_bar_place(const ColourScale& scale, const RgbaImage& scene) const;
  void draw_colour_bar(const ColourScale& scale, BarPlace place);
  /// The map's axes, upper right.
  void draw_axes(const Camera& camera);

 private:
  struct PlacedBar {
    ColourBar bar;
    DrawingArea room;
  };
  void take(const DrawingArea& area) { taken_.push_back(area); }
  [[nodiscard]] Lettering lettering(double size, Colour colour, bool is_bold = false,
                                    Anchor anchor = Anchor::kStart) const;
  [[nodiscard]] bool is_free(const DrawingArea& area) const;
  [[nodiscard]] double covered_share(const DrawingArea& area, const RgbaImage& scene) const;
  [[nodiscard]] std::optional<PlacedBar> placed_bar(const ColourScale& scale, BarPlace place) const;
  [[nodiscard]] Point2 bar_corner(const DrawingArea& room, BarPlace place) const;
  struct Axis {
    const char* name;
    Point3 direction;
    Colour colour;
    Point2 along = Point2::Zero();  ///< in the picture, of its length
  };
  void draw_axis_letters(const Point2& centre, std::span<const Axis> axes);

  Canvas& canvas_;
  Theme theme_;
  bool is_transparent_;
  double letter_;
  double margin_;
  std::vector<DrawingArea> taken_;
};

/// The picture with the colour bar at that place; nothing: where it covers least.
Canvas cloud_picture_at(std::optional<BarPlace> place, std::shared_ptr<const RgbaImage> scene, const ColourScale& scale,
                        const Camera& camera, const CloudLook& look, const CloudCaption& caption);
/// Where cloud_picture would put the colour bar: the first frame's place is that of the whole film.
std::optional<BarPlace> bar_place_of(const RgbaImage& scene, const ColourScale& scale, const Camera& camera,
                                     const CloudLook& look, const CloudCaption& caption);

}  // namespace gdtslam
