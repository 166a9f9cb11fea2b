#include "gl_context.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glew.h>
#include <fmt/format.h>
#include <vtkLogger.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>
#include <vtkTimerLog.h>

#include <array>
#include <memory>
#include <mutex>
#include <sstream>
#include <utility>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

[[noreturn]] void fail_egl(const std::string& name, const std::string& call) {
  throw DeviceError(name, call, fmt::format("EGL error {:#x}", eglGetError()));
}

bool has_word(const char* words, const std::string& word) {
  return words != nullptr && (" " + std::string(words) + " ").find(" " + word + " ") != std::string::npos;
}

template <typename Function>
Function egl_function(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

std::string gl_text(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text));
}

// Whether there is a configuration with this kind of surface.
bool choose_config(GlDisplay& display, EGLint surface_type) {
  const std::array<EGLint, 13> attributes{EGL_SURFACE_TYPE,
                                          surface_type,
                                          EGL_RENDERABLE_TYPE,
                                          EGL_OPENGL_BIT,
                                          EGL_RED_SIZE,
                                          8,
                                          EGL_GREEN_SIZE,
                                          8,
                                          EGL_BLUE_SIZE,
                                          8,
                                          EGL_ALPHA_SIZE,
                                          8,
                                          EGL_NONE};
  EGLint count = 0;
  if (eglChooseConfig(display.display, attributes.data(), &display.config, 1, &count) == EGL_FALSE) {
    fail_egl(display.name, "eglChooseConfig");
  }
  return count > 0;
}

/// A display that may work.
struct Candidate {
  std::string name;
  EGLenum platform = 0;  ///< 0: the default display
  void* native = EGL_DEFAULT_DISPLAY;
};

// Candidates in the order of trial: Mesa's surfaceless platform, every device of EGL_EXT_device_enumeration, the
// default display.
std::vector<Candidate> egl_candidates() {
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  std::vector<Candidate> candidates;
  if (has_word(extensions, "EGL_MESA_platform_surfaceless")) {
    candidates.push_back({"EGL (surfaceless)", EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY});
  }
  const auto query_devices = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  if (has_word(extensions, "EGL_EXT_platform_device") && query_devices != nullptr) {
    std::array<EGLDeviceEXT, 32> devices{};
    EGLint count = 0;
    if (query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count) == EGL_FALSE) count = 0;
    for (EGLint i = 0; i < count; ++i) {
      candidates.push_back(
          {"EGL (device " + std::to_string(i) + ")", EGL_PLATFORM_DEVICE_EXT, devices.at(static_cast<std::size_t>(i))});
    }
  }
  candidates.push_back({"EGL (default display)"});
  return candidates;
}

EGLDisplay get_display(const Candidate& candidate) {
  if (candidate.platform == 0) return eglGetDisplay(EGL_DEFAULT_DISPLAY);
  const auto get = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  return get == nullptr ? EGL_NO_DISPLAY : get(candidate.platform, candidate.native, nullptr);
}

// Proves by a context that the display works, and reads the driver's name.
void prove(GlDisplay& display) {
  GlContext context(display);
  context.make_current();
  const std::string version = gl_text(GL_VERSION);
  if (version.empty()) throw DeviceError(display.name, "glGetString", "nothing");
  const std::string loaded = load_gl_functions();
  if (!loaded.empty()) throw DeviceError(display.name, "glewInit", loaded);
  GLint major = 0;
  GLint minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  display.renderer = gl_text(GL_RENDERER);
  display.version = std::to_string(major) + "." + std::to_string(minor);
  if (major < 3 || (major == 3 && minor < 2)) {
    throw DeviceError(display.name, "a context", "OpenGL " + display.version + " (" + version + "), and 3.2 is needed");
  }
}

GlDisplay open_display(const Candidate& candidate) {
  GlDisplay display{.name = candidate.name, .display = get_display(candidate)};
  if (display.display == EGL_NO_DISPLAY) throw DeviceError(display.name, "eglGetDisplay", "no display");
  if (eglInitialize(display.display, nullptr, nullptr) == EGL_FALSE) fail_egl(display.name, "eglInitialize");
  display.has_surface = choose_config(display, EGL_PBUFFER_BIT);
  if (!display.has_surface) {
    const bool needs_none = has_word(eglQueryString(display.display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context");
    if (!needs_none || !choose_config(display, 0)) {
      throw DeviceError(display.name, "eglChooseConfig", "no configuration for OpenGL");
    }
  }
  prove(display);
  return display;
}

std::vector<std::string>& errors_of_this_thread() {
  thread_local std::vector<std::string> errors;
  return errors;
}

// Joins the lines of a message such as "ERROR: In FILE, line 12 vtkClass (0x55d0): text".
std::string one_line(const char* text) {
  std::istringstream words(text == nullptr ? "" : text);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line;
}

class Collector : public vtkOutputWindow {
 public:
  static Collector* New() {
    auto* collector = new Collector;
    collector->InitializeObjectBase();
    return collector;
  }
  void DisplayText(const char* /*text*/) override {}
  void DisplayErrorText(const char* text) override { errors_of_this_thread().push_back(one_line(text)); }
  void DisplayWarningText(const char* /*text*/) override {}
  void DisplayGenericWarningText(const char* /*text*/) override {}
  void DisplayDebugText(const char* /*text*/) override {}
};

}  // namespace

GlContext::GlContext(const GlDisplay& display) : name_(display.name), display_(display.display) {
  if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) fail_egl(name_, "eglBindAPI(EGL_OPENGL_API)");
  const std::array<EGLint, 7> attributes{
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 2, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  if (display.has_surface) {
    const std::array<EGLint, 5> one_pixel{EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
    surface_ = eglCreatePbufferSurface(display_, display.config, one_pixel.data());
    if (surface_ == EGL_NO_SURFACE) fail_egl(name_, "eglCreatePbufferSurface");
  }
  context_ = eglCreateContext(display_, display.config, EGL_NO_CONTEXT, attributes.data());
  if (context_ != EGL_NO_CONTEXT) return;
  const EGLint code = eglGetError();
  if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
  throw DeviceError(name_, "eglCreateContext", fmt::format("EGL error {:#x}", code));
}

GlContext::~GlContext() {
  if (is_current()) eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
  eglDestroyContext(display_, context_);
}

void GlContext::make_current() {
  if (eglMakeCurrent(display_, surface_, surface_, context_) == EGL_FALSE) fail_egl(name_, "eglMakeCurrent");
}

bool GlContext::is_current() const { return eglGetCurrentContext() == context_; }

std::string load_gl_functions() {
  // GLEW has one table of functions and driver properties per process: it is filled once per driver, so that nothing
  // changes while another thread draws.
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

GraphicsContext::GraphicsContext() {
  std::string failures;
  for (const Candidate& candidate : egl_candidates()) {
    try {
      state_ = std::make_unique<State>(State{open_display(candidate)});
      collect_vtk_messages();
      return;
    } catch (const DeviceError& error) {
      failures += (failures.empty() ? "" : "; ") + std::string(error.what());
    }
  }
  throw UnavailableError("nothing here can draw with OpenGL: " + failures +
                         "; install a software renderer (apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri)");
}

GraphicsContext::~GraphicsContext() = default;

std::string GraphicsContext::description() const {
  const GlDisplay& display = state_->display;
  return display.name + ", " + display.renderer + ", OpenGL " + display.version;
}

void collect_vtk_messages() {
  static std::once_flag once;
  std::call_once(once, [] {
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    const auto collector = vtkSmartPointer<Collector>::New();
    vtkOutputWindow::SetInstance(collector);
    vtkTimerLog::LoggingOff();  // VTK keeps one log of its events for all threads that draw, without a lock
  });
}

std::vector<std::string> take_vtk_errors() { return std::exchange(errors_of_this_thread(), {}); }

}  // namespace gdtslam
