// The points of a cloud in a picture: pieces of up to 64 Ki points in the order of time, so that the points up to a
// stamp are shown by leaving out later pieces and cutting one. A point's size is that of a disc in space, so that
// surfaces close near and far alike. 16 bytes a point, 4 where the points have different stamps, and 4 while a picture
// is drawn in several bands. One object belongs to one thread.
#pragma once

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
#include "viewer/graphics/dot_painter.hpp"
#include "viewer/graphics/picture_view.hpp"

namespace gdtslam {

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
  void set(std::span<const CloudPoint> cloud, std::vector<std::uint32_t> drawn, const LookOf& look_of);
  /// Points up to this stamp; equal stamps together, times within a piece to 2^-32 of its length. Points without a
  /// stamp that is a number are shown always.
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
