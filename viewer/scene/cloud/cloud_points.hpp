// The points of a cloud in OpenGL: pieces of up to 64 Ki points in the order of time, each with its own buffer, so that
// the points up to a stamp are shown by hiding later pieces and cutting one; nothing is sent to OpenGL again. A point's
// size is that of a disc in space, so that surfaces close near and far alike. 16 bytes a point, which OpenGL takes over
// with the first picture, and 4 where the points have different stamps. One object belongs to one thread.
#pragma once

#include <vtkNew.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/viewer/camera.hpp"

class vtkRenderer;

namespace gdtslam {

/// How large a point is drawn.
struct PointSizes {
  double fixed_px = 0.0;  ///< of every point; 0: by their size in space
  double least_px = 1.0;  ///< in the picture
  double largest_px = 1.0;
  std::uint32_t samples = 1;  ///< per pixel side, as the view renders
};

class CloudPoints {
 public:
  explicit CloudPoints(vtkRenderer& renderer);
  ~CloudPoints();
  CloudPoints(const CloudPoints&) = delete;
  CloudPoints& operator=(const CloudPoints&) = delete;

  /// Colour and diameter in space, metres, of a point of the cloud.
  struct Dot {
    Colour colour;
    double diameter_m = 0.0;
  };
  using DotOf = std::function<Dot(std::uint32_t)>;
  /// `drawn` are indices into the cloud; they are put into the order of time.
  void set(std::span<const CloudPoint> cloud, std::vector<std::uint32_t> drawn, const DotOf& dot_of);
  /// Points up to this stamp; equal stamps together, times within a piece to 2^-32 of its length. Points without a
  /// stamp that is a number are shown always.
  void show_until(double stamp_s);
  void set_sizes(const PointSizes& sizes, const Camera& camera, const PictureSize& size);
  /// A place that no point nearer to a perspective camera hides; nothing: each point hides what is behind it.
  void keep_in_view(const std::optional<Point3>& place);
  [[nodiscard]] std::uint64_t shown() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
