#include "offscreen_view.hpp"

#include <GL/glew.h>
#include <vtkCamera.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkOpenGLFramebufferObject.h>
#include <vtkPropCollection.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/viewer/camera.hpp"
#include "gl_context.hpp"

namespace gdtslam {
namespace {

// OpenGL skips points whose centre is outside the band, however large they are; none of its props is wider than this.
constexpr std::uint32_t kBandMargin = 4;
// Some 40 bytes per pixel. Each band costs a few milliseconds, and clouds need the memory themselves.
constexpr std::uint32_t kPointsBandPixels = 1U << 20U;
constexpr std::uint32_t kShapesBandPixels = 1U << 22U;

/// VTK's window on one of our contexts: without a window system; pictures are read from its framebuffer.
class RenderWindow : public vtkGenericOpenGLRenderWindow {
 public:
  static RenderWindow* New();

  /// The context must outlive the window.
  void set_context(GlContext* context) { context_ = context; }
  /// Reason why OpenGL's functions could not be loaded; empty on success.
  [[nodiscard]] const std::string& loading_failure() const { return loading_failure_; }

  void OpenGLInitContext() override;
  void MakeCurrent() override;
  bool IsCurrent() override;
  int SupportsOpenGL() override { return 1; }
  vtkTypeBool IsDirect() override { return 1; }

 protected:
  RenderWindow();
  ~RenderWindow() override = default;

 private:
  GlContext* context_ = nullptr;
  std::string loading_failure_;
};

RenderWindow* RenderWindow::New() {
  auto* window = new RenderWindow;
  window->InitializeObjectBase();
  return window;
}

RenderWindow::RenderWindow() {
  this->SetMultiSamples(0);
  this->SetAlphaBitPlanes(1);
  this->SetShowWindow(false);
  this->SetUseOffScreenBuffers(true);  // the picture is read from a framebuffer object, never copied to the surface
  this->SetSupportsOpenGL(1);
  this->SetIsDirect(1);
}

// VTK's own code, except that it accepts glewInit's result "no X display", which comes after everything is loaded.
void RenderWindow::OpenGLInitContext() {
  this->ContextCreationTime.Modified();
  if (this->Initialized) return;
  loading_failure_ = load_gl_functions();
  this->GlewInitValid = loading_failure_.empty();
  this->Initialized = this->GlewInitValid;
}

void RenderWindow::MakeCurrent() {
  if (context_ != nullptr && !context_->is_current()) context_->make_current();
}

bool RenderWindow::IsCurrent() { return context_ != nullptr && context_->is_current(); }

}  // namespace

struct OffscreenView::State {
  GlContext context;
  vtkNew<RenderWindow> window;
  vtkNew<vtkRenderer> renderer;
  Colour background = ink::kNight;
  bool is_transparent = false;
  bool has_eye_dome = false;
  std::uint32_t samples = 1;
  std::uint32_t largest_side = 0;
  PictureLayer* layer = nullptr;

  explicit State(const GraphicsContext& graphics) : context(graphics.state().display) {}
  ~State() {
    // VTK frees its buffers in their own context.
    context.make_current();
    window->Finalize();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

namespace {

std::uint32_t largest_side_of_context() {
  GLint renderbuffer = 0;
  GLint texture = 0;
  std::array<GLint, 2> viewport{};
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &renderbuffer);
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport.data());
  return static_cast<std::uint32_t>(std::min({renderbuffer, texture, viewport[0], viewport[1]}));
}

void check_size(const PictureSize& size, std::uint32_t samples, std::uint32_t largest) {
  const std::string text = std::to_string(size.width) + "x" + std::to_string(size.height);
  if (std::max(size.width, size.height) <= largest / samples) return;
  throw UsageError("a picture of " + text + " pixels with " + std::to_string(samples) +
                   " samples a side is beyond what OpenGL can draw here, " + std::to_string(largest / samples) +
                   " pixels a side");
}

void throw_errors_of_vtk() {
  const std::vector<std::string> errors = take_vtk_errors();
  if (!errors.empty()) throw DeviceError("VTK", "rendering", errors.front());
}

/// Nearest and farthest distance along the view to the corners of the bounds.
std::array<double, 2> depth_span(const std::array<double, 6>& bounds, const Point3& eye, const Point3& ahead) {
  std::array<double, 2> span{1e300, -1e300};
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const Point3 point(bounds.at(corner & 1U), bounds.at(2 + (corner >> 1U & 1U)), bounds.at(4 + (corner >> 2U)));
    const double depth = (point - eye).dot(ahead);
    span = {std::min(span[0], depth), std::max(span[1], depth)};
  }
  return span;
}

/// Bounds of the props and the layer, in VTK's order.
std::array<double, 6> visible_bounds(vtkRenderer& renderer, const PictureLayer* layer) {
  std::array<double, 6> all{};
  renderer.ComputeVisiblePropBounds(all.data());
  if (layer == nullptr || layer->bounds().is_empty()) return all;
  const Bounds& more = layer->bounds();
  if (all[0] > all[1]) all = {1e300, -1e300, 1e300, -1e300, 1e300, -1e300};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    all.at(2 * axis) = std::min(all.at(2 * axis), more.lowest[static_cast<Eigen::Index>(axis)]);
    all.at(2 * axis + 1) = std::max(all.at(2 * axis + 1), more.highest[static_cast<Eigen::Index>(axis)]);
  }
  return all;
}

/// Sets the view's camera and range so that nothing in front of the eye is clipped (for a parallel camera: nothing at
/// all).
void set_range(PictureView& view, const std::array<double, 6>& bounds) {
  Camera& camera = view.camera;
  const double distance = (camera.target - camera.eye).norm();
  const Point3 ahead = (camera.target - camera.eye) / distance;
  DepthRange range{0.1 * distance, 2.0 * distance, camera.is_parallel, 1.0};
  if (bounds[0] <= bounds[1]) {
    std::array<double, 2> span = depth_span(bounds, camera.eye, ahead);
    const double margin = 0.01 * (span[1] - span[0]) + 1e-3 * distance;
    if (camera.is_parallel && span[0] < 2.0 * margin) {
      const double back = 2.0 * margin - span[0];
      camera.eye -= back * ahead;
      span = {span[0] + back, span[1] + back};
    }
    range.farthest_m = std::max(span[1] + margin, 1e-3 * distance);
    // A single outlier far away must not clip the camera's target.
    range.nearest_m = std::max(span[0] - margin, 1e-3 * std::min(range.farthest_m, 100.0 * distance));
  }
  // 0.6 rad, the view angle of a Camera by default: 1/(2 tan 0.3).
  range.equivalent_m = 1.6163642 * camera.parallel_height_m;
  view.range = range;
}

/// Points VTK's camera at a band by the slopes of its lower and upper edge, or metres for a parallel camera.
void point_camera(vtkRenderer& renderer, const PictureView& view, const PictureBand& band) {
  const Camera& camera = view.camera;
  const double low = 2.0 * band.first_row / view.height - 1.0;
  const double high = 2.0 * (band.first_row + band.rows) / view.height - 1.0;
  const double share = 0.5 * (high - low);
  vtkCamera& vtk = *renderer.GetActiveCamera();
  vtk.SetPosition(camera.eye.x(), camera.eye.y(), camera.eye.z());
  vtk.SetFocalPoint(camera.target.x(), camera.target.y(), camera.target.z());
  vtk.SetViewUp(camera.up.x(), camera.up.y(), camera.up.z());
  vtk.SetUseHorizontalViewAngle(0);
  const double angle_rad =
      band.rows == view.height ? camera.view_angle_rad : 2.0 * atan2(share * half_height_slope(camera), 1.0);
  vtk.SetViewAngle(angle_rad * 180.0 / kPi);
  vtk.SetParallelProjection(camera.is_parallel ? 1 : 0);
  vtk.SetParallelScale(0.5 * share * camera.parallel_height_m);
  vtk.SetWindowCenter(0.0, 0.5 * (high + low) / share);
  vtk.SetClippingRange(view.range.nearest_m, view.range.farthest_m);
}

RawPicture read_back(RenderWindow& window, bool with_depth) {
  RawPicture picture;
  const int* size = window.GetSize();
  picture.width = static_cast<std::uint32_t>(size[0]);
  picture.height = static_cast<std::uint32_t>(size[1]);
  const std::size_t count = std::size_t{picture.width} * picture.height;
  vtkOpenGLFramebufferObject& framebuffer = *window.GetRenderFramebuffer();
  framebuffer.Bind(GL_READ_FRAMEBUFFER);
  framebuffer.ActivateReadBuffer(0);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  picture.rgba.resize(4 * count);
  glReadPixels(0, 0, size[0], size[1], GL_RGBA, GL_UNSIGNED_BYTE, picture.rgba.data());
  if (with_depth) {
    picture.depth.resize(count);
    glReadPixels(0, 0, size[0], size[1], GL_DEPTH_COMPONENT, GL_FLOAT, picture.depth.data());
  }
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    throw DeviceError("OpenGL", "glReadPixels", error == GL_OUT_OF_MEMORY ? "out of memory" : std::to_string(error));
  }
  return picture;
}

RawPicture drawn_over(Colour background, double alpha, RenderWindow& window, vtkRenderer& renderer, bool with_depth) {
  renderer.SetBackground(background.red / 255.0, background.green / 255.0, background.blue / 255.0);
  renderer.SetBackgroundAlpha(alpha);
  window.Render();
  if (!window.loading_failure().empty()) throw DeviceError("OpenGL", "glewInit", window.loading_failure());
  throw_errors_of_vtk();
  return read_back(window, with_depth);
}

bool has_translucent_props(vtkRenderer& renderer) {
  vtkPropCollection& props = *renderer.GetViewProps();
  vtkCollectionSimpleIterator place = nullptr;
  props.InitTraversal(place);
  while (vtkProp* prop = props.GetNextProp(place)) {
    if (prop->GetVisibility() != 0 && prop->HasTranslucentPolygonalGeometry() != 0) return true;
  }
  return false;
}

/// Draws over transparent black, so that colours are premultiplied by their coverage.
RawPicture drawn_over_nothing(RenderWindow& window, vtkRenderer& renderer, bool with_depth) {
  RawPicture picture = drawn_over({0, 0, 0}, 0.0, window, renderer, with_depth);
  // VTK blends translucent props with the right colours but squares their alpha.
  if (has_translucent_props(renderer)) {
    set_alpha_from(picture, drawn_over({255, 255, 255}, 1.0, window, renderer, false));
  }
  return picture;
}

}  // namespace

std::vector<PictureBand> cut_into_bands(std::uint32_t width, std::uint32_t height, const BandShape& shape) {
  const auto& [samples, margin, most_pixels] = shape;
  if (width * std::uint64_t{height} <= most_pixels) return {{0, height, 0, height}};
  // Keeps at least as many rows as it draws only for the margin.
  const std::uint32_t wanted = std::max(most_pixels / width, 4 * margin + samples);
  const std::uint32_t kept = std::max((wanted - std::min(wanted, 2 * margin)) / samples, 1U) * samples;
  const std::uint32_t rows = std::min(height, kept + 2 * margin);
  std::vector<PictureBand> bands;
  bands.reserve(height / kept + 1);
  for (std::uint32_t row = 0; row < height; row += kept) {
    const std::uint32_t first = std::min(row - std::min(row, margin), height - rows);
    bands.push_back({first, rows, row, std::min(kept, height - row)});
  }
  return bands;
}

OffscreenView::OffscreenView(const GraphicsContext& graphics) : state_(std::make_unique<State>(graphics)) {
  State& s = *state_;
  s.context.make_current();
  s.largest_side = largest_side_of_context();
  s.window->set_context(&s.context);
  s.window->AddRenderer(s.renderer);
}

OffscreenView::~OffscreenView() = default;

vtkRenderer& OffscreenView::renderer() { return *state_->renderer; }

void OffscreenView::set_background(Colour colour, bool is_transparent) {
  state_->background = colour;
  state_->is_transparent = is_transparent;
}

void OffscreenView::set_eye_dome(bool is_on) { state_->has_eye_dome = is_on; }

void OffscreenView::set_samples(std::uint32_t samples) {
  assert(samples >= 1 && samples <= 4);
  state_->samples = samples;
}

std::uint32_t OffscreenView::samples() const { return state_->samples; }

void OffscreenView::set_layer(PictureLayer* layer) { state_->layer = layer; }

RgbaImage OffscreenView::render(const Camera& camera, const PictureSize& size) {
  State& s = *state_;
  check_size(size, s.samples, s.largest_side);
  s.context.make_current();
  // One pixel for pictures up to 720 rows, more for larger ones.
  const std::uint32_t radius = s.samples * std::max(1U, (size.height + 360U) / 720U);
  const std::uint32_t margin = std::max(s.has_eye_dome ? shading_reach(radius) : 0, kBandMargin * s.samples);
  PictureView view{
      .camera = camera, .range = {}, .width = size.width * s.samples, .height = size.height * s.samples, .bands = {}};
  view.bands = cut_into_bands(view.width, view.height,
                              {s.samples, margin, s.layer == nullptr ? kShapesBandPixels : kPointsBandPixels});
  set_range(view, visible_bounds(*s.renderer, s.layer));
  if (s.layer != nullptr) s.layer->begin(view);
  s.window->SetSize(static_cast<int>(view.width), static_cast<int>(view.bands.front().rows));
  const bool with_depth = s.has_eye_dome || s.layer != nullptr;
  RgbaImage image(size.width, size.height);
  for (std::size_t k = 0; k < view.bands.size(); ++k) {
    const PictureBand& band = view.bands[k];
    point_camera(*s.renderer, view, band);
    RawPicture picture = s.is_transparent ? drawn_over_nothing(*s.window, *s.renderer, with_depth)
                                          : drawn_over(s.background, 1.0, *s.window, *s.renderer, with_depth);
    if (s.layer != nullptr) s.layer->draw(k, picture);
    if (s.has_eye_dome) shade_eye_dome(picture, view.range, radius);
    average_rows(picture,
                 {.first = band.first_kept - band.first_row,
                  .image_row = band.first_kept / s.samples,
                  .count = band.kept / s.samples},
                 s.samples, s.is_transparent, image);
  }
  return image;
}

}  // namespace gdtslam
