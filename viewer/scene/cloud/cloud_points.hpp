// The points of a cloud, drawn by the CPU as discs in front of more distant parts of the picture. A disc has its size
// in space, so that surfaces close near and far alike, and one depth. The same on every machine; some 30 ns a disc.
// Pieces of up to 64 Ki points are sorted by time: drawing up to a stamp skips later pieces and cuts one. 16 bytes a
// point, 8 more if stamps differ, 4 more while a picture is drawn in several bands. One object belongs to one thread.
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

/// Encodes a diameter in space in 8 bits, in steps of 3.5 %: 1 mm to 6.9 m.
std::uint8_t diameter_code(double diameter_m);

/// Limits of the discs' sizes, in samples.
struct DotSizes {
  double least_px = 1.0;
  double largest_px = 1.0;
};

/// A position and the radius around it, across the line of sight, that points do not hide.
struct KeptInView {
  Point3 place = Point3::Zero();
  double radius_m = 0.5;  ///< infinity: everything in front of it is cut away
};

class DotPainter {
 public:
  /// Dots are relative to `origin`. `kept_in_view`: dots between a perspective camera and this position, within a cone,
  /// are skipped unless they are lower than it (the floor).
  DotPainter(const PictureView& view, const Point3& origin, const DotSizes& sizes,
             const std::optional<KeptInView>& kept_in_view);

  /// First row and end row of the dot within the picture; equal if it is not visible.
  struct RowRange {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };
  [[nodiscard]] RowRange touched_rows(const Dot& dot) const;
  /// Draws into the picture of a band.
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
  std::array<float, 256> size_px_{};  ///< by size code, at a distance of one metre
  struct Kept {
    float x = 0.0F;
    float y = 0.0F;
    float distance_m = 0.0F;
    float height_m = 0.0F;  ///< from the origin
    float radius = 0.0F;    ///< pixels
  };
  std::optional<Kept> kept_;
};

/// Limits of the points' sizes.
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
  /// `drawn` are indices into the cloud; they are sorted by time here.
  void set(std::span<const CloudPoint> cloud, std::vector<std::uint32_t> drawn, const LookOf& point_look);
  /// Shows points up to this stamp, inclusive. Points without a valid stamp are always shown.
  void show_until(double stamp_s);
  void set_sizes(const PointSizes& sizes);
  /// A position that no point nearer to a perspective camera hides; empty: none.
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
