#include "gdtslam/viewer/graphics.hpp"

#include <utility>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "graphics/graphics_state.hpp"
#include "graphics/vtk_messages.hpp"

namespace gdtslam {
namespace {

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
  return all;
}

std::string advice(GraphicsChoice choice) {
  std::string egl = "install a software renderer (apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri)";
  std::string x11 = "use a virtual display (apt-get install xvfb xauth; xvfb-run -a gdtslam ...)";
  if (choice == GraphicsChoice::kEgl) return egl;
  if (choice == GraphicsChoice::kX11) return x11;
  return egl + " or " + x11;
}

}  // namespace

GraphicsContext::GraphicsContext(GraphicsChoice choice) : state_(std::make_unique<State>()) {
  std::vector<std::string> failures;
  if (choice != GraphicsChoice::kX11) state_->platform = open_egl(failures, state_->driver);
  if (state_->platform != nullptr) failures.clear();
  if (state_->platform == nullptr && choice != GraphicsChoice::kEgl) {
    state_->platform = open_x11(failures, state_->driver);
  }
  if (state_->platform == nullptr) {
    throw UnavailableError("nothing here can draw with OpenGL: " + joined(failures) + "; " + advice(choice));
  }
  if (!failures.empty()) state_->fallback = "drawing through the X server, because " + joined(failures);
  collect_vtk_messages();
}

GraphicsContext::~GraphicsContext() = default;

std::string GraphicsContext::description() const {
  return state_->platform->name() + ", " + state_->driver.renderer + ", OpenGL " + state_->driver.version;
}

bool GraphicsContext::is_fallback() const { return !state_->fallback.empty(); }

std::string GraphicsContext::description_of_fallback() const { return state_->fallback; }

std::vector<std::string> GraphicsContext::take_warnings() const { return take_vtk_warnings(); }

}  // namespace gdtslam
