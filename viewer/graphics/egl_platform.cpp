// EGL: OpenGL without X [Khronos, EGL 1.5]. Tried in this order: Mesa's surfaceless platform, every device that
// EGL_EXT_device_enumeration names, the default display.
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <map>
#include <mutex>
#include <utility>

#include "gdtslam/core/error.hpp"
#include "gl_platform.hpp"

namespace gdtslam {
namespace {

std::string egl_error_name(EGLint code) {
  static const std::map<EGLint, std::string> names{
      {EGL_SUCCESS, "EGL_SUCCESS"},
      {EGL_NOT_INITIALIZED, "EGL_NOT_INITIALIZED"},
      {EGL_BAD_ACCESS, "EGL_BAD_ACCESS"},
      {EGL_BAD_ALLOC, "EGL_BAD_ALLOC"},
      {EGL_BAD_ATTRIBUTE, "EGL_BAD_ATTRIBUTE"},
      {EGL_BAD_CONFIG, "EGL_BAD_CONFIG"},
      {EGL_BAD_CONTEXT, "EGL_BAD_CONTEXT"},
      {EGL_BAD_CURRENT_SURFACE, "EGL_BAD_CURRENT_SURFACE"},
      {EGL_BAD_DISPLAY, "EGL_BAD_DISPLAY"},
      {EGL_BAD_MATCH, "EGL_BAD_MATCH"},
      {EGL_BAD_NATIVE_PIXMAP, "EGL_BAD_NATIVE_PIXMAP"},
      {EGL_BAD_NATIVE_WINDOW, "EGL_BAD_NATIVE_WINDOW"},
      {EGL_BAD_PARAMETER, "EGL_BAD_PARAMETER"},
      {EGL_BAD_SURFACE, "EGL_BAD_SURFACE"},
      {EGL_CONTEXT_LOST, "EGL_CONTEXT_LOST"},
      {EGL_BAD_DEVICE_EXT, "EGL_BAD_DEVICE_EXT"},
  };
  const auto found = names.find(code);
  return found != names.end() ? found->second : "EGL error " + std::to_string(code);
}

[[noreturn]] void fail_egl(const std::string& name, const std::string& call) {
  throw DeviceError(name, call, egl_error_name(eglGetError()));
}

bool has_word(const char* words, const std::string& word) {
  return words != nullptr && (" " + std::string(words) + " ").find(" " + word + " ") != std::string::npos;
}

template <typename Function>
Function egl_function(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

// EGL has one display per kind and device in a process, and ending it ends all contexts in it: so it is counted.
class DisplayUse {
 public:
  DisplayUse(EGLDisplay display, const std::string& name) : display_(display) {
    const std::lock_guard lock(mutex());
    if (counts()[display] == 0 && eglInitialize(display, nullptr, nullptr) == EGL_FALSE)
      fail_egl(name, "eglInitialize");
    ++counts()[display];
  }
  ~DisplayUse() {
    const std::lock_guard lock(mutex());
    if (--counts()[display_] == 0) eglTerminate(display_);
  }
  DisplayUse(const DisplayUse&) = delete;
  DisplayUse& operator=(const DisplayUse&) = delete;
  [[nodiscard]] EGLDisplay get() const { return display_; }

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  static std::map<EGLDisplay, int>& counts() {
    static std::map<EGLDisplay, int> all;
    return all;
  }
  EGLDisplay display_;
};

class EglContext : public GlContext {
 public:
  EglContext(std::shared_ptr<const DisplayUse> display, EGLConfig config, bool has_surface, std::string name)
      : display_(std::move(display)), name_(std::move(name)) {
    if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) fail_egl(name_, "eglBindAPI(EGL_OPENGL_API)");
    const std::array<EGLint, 7> attributes{
        EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 2, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    context_ = eglCreateContext(display_->get(), config, EGL_NO_CONTEXT, attributes.data());
    if (context_ == EGL_NO_CONTEXT) fail_egl(name_, "eglCreateContext");
    if (!has_surface) return;
    const std::array<EGLint, 5> one_pixel{EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
    surface_ = eglCreatePbufferSurface(display_->get(), config, one_pixel.data());
    if (surface_ == EGL_NO_SURFACE) {
      const EGLint error = eglGetError();
      eglDestroyContext(display_->get(), context_);
      throw DeviceError(name_, "eglCreatePbufferSurface", egl_error_name(error));
    }
  }
  ~EglContext() override {
    if (is_current()) eglMakeCurrent(display_->get(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_->get(), surface_);
    eglDestroyContext(display_->get(), context_);
  }
  void make_current() override {
    if (eglMakeCurrent(display_->get(), surface_, surface_, context_) == EGL_FALSE) fail_egl(name_, "eglMakeCurrent");
  }
  [[nodiscard]] bool is_current() const override { return eglGetCurrentContext() == context_; }

 private:
  std::shared_ptr<const DisplayUse> display_;
  std::string name_;
  EGLContext context_ = EGL_NO_CONTEXT;
  EGLSurface surface_ = EGL_NO_SURFACE;
};

// Whether there is a configuration with this kind of surface.
bool choose_config(EGLDisplay display, EGLint surface_type, const std::string& name, EGLConfig& config) {
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
  if (eglChooseConfig(display, attributes.data(), &config, 1, &count) == EGL_FALSE) fail_egl(name, "eglChooseConfig");
  return count > 0;
}

GlPlatform proven_platform(EGLDisplay native, const std::string& name) {
  const auto display = std::make_shared<const DisplayUse>(native, name);
  EGLConfig config = nullptr;
  const bool has_surface = choose_config(native, EGL_PBUFFER_BIT, name, config);
  if (!has_surface) {
    const bool needs_none = has_word(eglQueryString(native, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context");
    if (!needs_none || !choose_config(native, 0, name, config)) {
      throw DeviceError(name, "eglChooseConfig", "no configuration for OpenGL");
    }
  }
  GlPlatform platform{.name = name, .make_context = [display, config, has_surface, name] {
                        return std::make_unique<EglContext>(display, config, has_surface, name);
                      }};
  prove(platform);
  return platform;
}

/// A display that may work.
struct Candidate {
  std::string name;
  EGLenum platform = 0;  ///< 0: the default display
  void* native = EGL_DEFAULT_DISPLAY;
};

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

EGLDisplay display_of(const Candidate& candidate) {
  if (candidate.platform == 0) return eglGetDisplay(EGL_DEFAULT_DISPLAY);
  const auto get = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  return get == nullptr ? EGL_NO_DISPLAY : get(candidate.platform, candidate.native, nullptr);
}

}  // namespace

std::optional<GlPlatform> open_egl(std::vector<std::string>& failures) {
  for (const Candidate& candidate : egl_candidates()) {
    try {
      EGLDisplay display = display_of(candidate);
      if (display == EGL_NO_DISPLAY) throw DeviceError(candidate.name, "eglGetDisplay", "no display");
      return proven_platform(display, candidate.name);
    } catch (const DeviceError& error) {
      failures.emplace_back(error.what());
    }
  }
  return std::nullopt;
}

}  // namespace gdtslam
