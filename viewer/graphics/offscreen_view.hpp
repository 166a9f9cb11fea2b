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
  /// A layer is drawn beside VTK's props; it must live while pictures are drawn. None by default. VTK's translucent
  /// props, which have no depth, stay behind it.
  void set_layer(PictureLayer* layer);
  /// Eye-dome lighting, so that the depth of clouds reads [Boucheny2009]; off by default.
  void set_eye_dome(bool is_on);
  /// Samples per pixel side: rendered larger and averaged; 1 to 4.
  void set_samples(std::uint32_t samples);
  /// Point sizes and line widths count in pixels of what is rendered: multiply those of the picture by this.
  [[nodiscard]] std::uint32_t samples() const;
  /// Throws UsageError for a side beyond what OpenGL can do (samples included), with the limit; DeviceError for what
  /// VTK or OpenGL fail at; std::bad_alloc. Nothing before the camera is cut off, and nothing at all by a parallel one.
  /// Costs a millisecond for each 100 000 pixels, samples counted, twice that with eye-dome lighting; what VTK draws
  /// comes on top.
  RgbaImage render(const Camera& camera, const PictureSize& size);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
