// The points of a cloud in a picture, drawn by the processor as discs, nearer than what the picture has already: a disc
// has its size in space, so that surfaces close near and far alike, and one depth. The same on every machine; some 30
// ns a disc. Points lie in pieces of up to 64 Ki in the order of time, so that the points up to a stamp are shown by
// leaving out later pieces and cutting one. 16 bytes a point, 8 if the points have different stamps, and 4 while a
// picture is drawn in several bands. One object belongs to one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/viewer/camera.hpp"
#include "viewer/graphics/picture_view.hpp"

namespace gdtslam {

/// A disc.
struct Dot {
  std::array<float, 3> place;  ///< from the cloud's origin, metres
  std::array<std::uint8_t, 3> colour;
  std::uint8_t size_code;  ///< see diameter_code()
};
static_assert(sizeof(Dot) == 16);

/// Diameters in space in 8 bits, each 3.5 % larger than the one before: 1 mm to 6.9 m.
std::uint8_t diameter_code(double diameter_m);

/// How large discs are drawn, in samples.
struct DotSizes {
  double least_px = 1.0;
  double largest_px = 1.0;
};

/// A place and how far around it, across the line of sight, nothing hides it.
struct KeptInView {
  Point3 place = Point3::Zero();
  double radius_m = 0.5;  ///< infinity: all that stands before it is cut away
};

class DotPainter {
 public:
  /// The dots' places count from `origin`. `kept_in_view`: a place that no dot nearer to a perspective camera hides:
  /// those in a cone around it are left out, but for what lies lower than it: the floor.
  DotPainter(const PictureView& view, const Point3& origin, const DotSizes& sizes,
             const std::optional<KeptInView>& kept_in_view);

  /// First row and row behind the last one that the dot touches, within the picture; the same where it is not seen.
  struct RowRange {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };
  [[nodiscard]] RowRange touched_rows(const Dot& dot) const;
  /// Into the picture of a band.
  void paint(const Dot& dot, const PictureBand& band, RawPicture& picture) const;

 private:
  /// Pixels from the picture's lower left corner.
  struct Disc {
    float x = 0.0F;
    float y = 0.0F;
    float depth = 0.0F;
    float size = 0.0F;  ///< 0: not seen
  };
  [[nodiscard]] Disc seen_disc(const Dot& dot) const;
  [[nodiscard]] bool hides_what_is_kept(const Dot& dot, float x, float y, float distance_m) const;

  // x = right . place + right_at, pixels at one metre's distance, and so on.
  Eigen::Vector3f right_;
  Eigen::Vector3f up_;
  Eigen::Vector3f ahead_;
  float right_at_ = 0.0F;
  float up_at_ = 0.0F;
  float ahead_at_ = 0.0F;
  bool is_parallel_ = false;
  float width_ = 0.0F;
  float height_ = 0.0F;
  float nearest_m_ = 0.0F;
  float farthest_m_ = 0.0F;
  DotSizes sizes_;
  std::array<float, 256> size_px_{};  ///< by size code, at one metre's distance
  struct Kept {
    float x = 0.0F;
    float y = 0.0F;
    float distance_m = 0.0F;
    float height_m = 0.0F;  ///< from the origin
    float radius = 0.0F;    ///< pixels
  };
  std::optional<Kept> kept_;
};

/// How large a point is drawn.
struct PointSizes {
  double least_px = 1.0;  ///< in the picture
  double largest_px = 1.0;
  std::uint32_t samples = 1;  ///< per pixel side, as the view renders
};

class CloudPoints : public PictureLayer {
 public:
  CloudPoints();
  ~CloudPoints() override;

  /// Colour and diameter in space, metres, of a point of the cloud.
  struct Look {
    Colour colour;
    double diameter_m = 0.0;
  };
  using LookOf = std::function<Look(std::uint32_t)>;
  /// `drawn` are indices into the cloud; they are put into the order of time.
  void set(std::span<const CloudPoint> cloud, std::vector<std::uint32_t> drawn, const LookOf& point_look);
  /// Points up to this stamp; equal stamps together. Points without a stamp that is a number are shown always.
  void show_until(double stamp_s);
  void set_sizes(const PointSizes& sizes);
  /// A place that no point nearer to a perspective camera hides; nothing: each point hides what is behind it.
  void keep_in_view(const std::optional<KeptInView>& kept);
  [[nodiscard]] std::uint64_t shown() const;

  [[nodiscard]] const Bounds& bounds() const override;
  void begin(const PictureView& view) override;
  void draw(std::size_t band, RawPicture& picture) override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
