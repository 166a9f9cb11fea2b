#include "gdtslam/viewer/graphics.hpp"

#include <utility>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "graphics_state.hpp"
#include "vtk_messages.hpp"

namespace gdtslam {
namespace {

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
  return all;
}

}  // namespace

GraphicsContext::GraphicsContext() : state_(std::make_unique<State>()) {
  std::vector<std::string> failures;
  state_->platform = open_egl(failures, state_->driver);
  if (state_->platform == nullptr) {
    throw UnavailableError("nothing here can draw with OpenGL: " + joined(failures) +
                           "; install a software renderer (apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri)");
  }
  collect_vtk_messages();
}

GraphicsContext::~GraphicsContext() = default;

std::string GraphicsContext::description() const {
  return state_->platform->name() + ", " + state_->driver.renderer + ", OpenGL " + state_->driver.version;
}

std::vector<std::string> GraphicsContext::take_warnings() const { return take_vtk_warnings(); }

}  // namespace gdtslam
