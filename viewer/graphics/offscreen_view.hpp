// A picture drawn with VTK in a GraphicsContext: supersampled for smooth edges, in bands of about a million samples,
// each read back as RGBA. The viewer's scenes add their props to renderer(). One object belongs to one thread.
#pragma once

#include <memory>

#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/drawing/image.hpp"
#include "gdtslam/viewer/camera.hpp"
#include "gdtslam/viewer/graphics.hpp"
#include "picture_view.hpp"

class vtkRenderer;

namespace gdtslam {

class OffscreenView {
 public:
  explicit OffscreenView(const GraphicsContext& graphics);
  ~OffscreenView();
  OffscreenView(const OffscreenView&) = delete;
  OffscreenView& operator=(const OffscreenView&) = delete;

  [[nodiscard]] vtkRenderer& renderer();
  void set_background(Colour colour, bool is_transparent);
  /// Sets a layer to draw together with VTK's props; it must live while pictures are drawn. None by default. VTK's
  /// translucent props, which have no depth, stay behind it.
  void set_layer(PictureLayer* layer);
  /// Eye-dome lighting, which shows the depth of clouds [Boucheny2009]; off by default.
  void set_eye_dome(bool is_on);
  /// Samples per pixel side, 1 to 4: the picture is rendered larger and averaged.
  void set_samples(std::uint32_t samples);
  /// Point sizes and line widths are in rendered pixels: multiply those of the picture by this.
  [[nodiscard]] std::uint32_t samples() const;
  /// Throws UsageError for a side beyond OpenGL's limit (samples included), with the limit; DeviceError for failures of
  /// VTK or OpenGL; std::bad_alloc. Nothing in front of the camera is clipped, and nothing at all by a parallel one.
  /// Costs a millisecond per 100 000 pixels, samples included, and twice that with eye-dome lighting, plus VTK's own
  /// time.
  RgbaImage render(const Camera& camera, const PictureSize& size);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
