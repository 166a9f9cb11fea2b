#include "gl_platform.hpp"

#include <GL/glew.h>

#include <mutex>
#include <utility>

#include "gdtslam/core/error.hpp"
#include "vtk_messages.hpp"

namespace gdtslam {
namespace {

std::string gl_text(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text));
}

}  // namespace

std::string load_gl_functions() {
  // GLEW keeps one table of functions and of what the driver can do for the process: it is filled once for a driver, so
  // that nothing changes under another thread that draws.
  static std::mutex mutex;
  static std::string filled_for;
  const std::lock_guard lock(mutex);
  const std::string driver = gl_text(GL_RENDERER) + "\n" + gl_text(GL_VERSION);
  if (driver == filled_for) return {};
  glewExperimental = GL_TRUE;
  const GLenum result = glewInit();
  // Debian's GLEW is built for GLX: under EGL it loads all of OpenGL and only then misses an X display
  // (github.com/nigels-com/glew issue 273).
  if (result == GLEW_OK || result == GLEW_ERROR_NO_GLX_DISPLAY) {
    filled_for = driver;
    return {};
  }
  const GLubyte* text = glewGetErrorString(result);
  return text == nullptr ? "error " + std::to_string(result) : std::string(reinterpret_cast<const char*>(text));
}

void prove(GlPlatform& platform) {
  const std::unique_ptr<GlContext> context = platform.make_context();
  context->make_current();
  const std::string version = gl_text(GL_VERSION);
  if (version.empty()) throw DeviceError(platform.name, "glGetString", "nothing");
  const std::string loaded = load_gl_functions();
  if (!loaded.empty()) throw DeviceError(platform.name, "glewInit", loaded);
  GLint major = 0;
  GLint minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  platform.renderer = gl_text(GL_RENDERER);
  platform.version = std::to_string(major) + "." + std::to_string(minor);
  if (major < 3 || (major == 3 && minor < 2)) {
    throw DeviceError(platform.name, "a context",
                      "OpenGL " + platform.version + " (" + version + "), and 3.2 is needed");
  }
}

GraphicsContext::GraphicsContext() {
  std::vector<std::string> failures;
  std::optional<GlPlatform> platform = open_egl(failures);
  if (!platform) {
    std::string joined;
    for (const std::string& failure : failures) joined += (joined.empty() ? "" : "; ") + failure;
    throw UnavailableError("nothing here can draw with OpenGL: " + joined +
                           "; install a software renderer (apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri)");
  }
  state_ = std::make_unique<State>(State{*std::move(platform)});
  collect_vtk_messages();
}

GraphicsContext::~GraphicsContext() = default;

std::string GraphicsContext::description() const {
  const GlPlatform& platform = state_->platform;
  return platform.name + ", " + platform.renderer + ", OpenGL " + platform.version;
}

std::vector<std::string> GraphicsContext::take_warnings() const { return take_vtk_warnings(); }

}  // namespace gdtslam
