// An X server that answers at DISPLAY, through GLX 1.3: a pbuffer of one pixel carries the context and nothing appears
// on the screen. VTK's own X window is never made, because it ends the process where anything is missing.
#include <GL/glx.h>
#include <X11/Xlib.h>

#include <array>
#include <cstdlib>
#include <map>
#include <mutex>
#include <utility>

#include "gdtslam/core/error.hpp"
#include "graphics/gl_platform.hpp"

namespace gdtslam {
namespace {

// Xlib ends the process on an error unless a handler says otherwise, and has one handler for all connections. Ours
// keeps the errors of our connections and hands on those of others; it stays, because errors arrive late.
class ErrorLog {
 public:
  static void add(Display* display) {
    const std::lock_guard lock(mutex());
    static const bool is_set = [] {
      previous() = XSetErrorHandler(&ErrorLog::handle);
      return true;
    }();
    static_cast<void>(is_set);
    codes()[display] = Success;
  }
  static void remove(Display* display) {
    const std::lock_guard lock(mutex());
    codes().erase(display);
  }
  /// The name of the first error of the connection since the last call, or an empty text. Waits for the server.
  static std::string take(Display* display) {
    XSync(display, False);
    int code = Success;
    {
      const std::lock_guard lock(mutex());
      code = std::exchange(codes()[display], Success);
    }
    if (code == Success) return {};
    std::array<char, 128> text{};
    XGetErrorText(display, code, text.data(), static_cast<int>(text.size()));
    return text.data();
  }

 private:
  static int handle(Display* display, XErrorEvent* event) {
    const std::lock_guard lock(mutex());
    const auto found = codes().find(display);
    if (found == codes().end()) return previous()(display, event);
    if (found->second == Success) found->second = event->error_code;
    return 0;
  }
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  static std::map<Display*, int>& codes() {
    static std::map<Display*, int> all;
    return all;
  }
  static XErrorHandler& previous() {
    static XErrorHandler handler = nullptr;
    return handler;
  }
};

/// A connection to the server.
class Connection {
 public:
  Connection() : display_(XOpenDisplay(nullptr)) {
    if (display_ == nullptr) throw DeviceError("X server", "XOpenDisplay", no_answer());
    ErrorLog::add(display_);
  }
  ~Connection() {
    XCloseDisplay(display_);
    ErrorLog::remove(display_);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  [[nodiscard]] Display* get() const { return display_; }

 private:
  static std::string no_answer() {
    const char* name = std::getenv("DISPLAY");
    if (name == nullptr || *name == '\0') return "no connection, because DISPLAY is not set";
    return "no connection to DISPLAY=" + std::string(name);
  }
  Display* display_;
};

class GlxContext : public GlContext {
 public:
  GlxContext(std::shared_ptr<const Connection> connection, GLXFBConfig config, std::string name)
      : connection_(std::move(connection)), name_(std::move(name)) {
    const auto create = reinterpret_cast<PFNGLXCREATECONTEXTATTRIBSARBPROC>(
        glXGetProcAddressARB(reinterpret_cast<const GLubyte*>("glXCreateContextAttribsARB")));
    if (create == nullptr) throw DeviceError(name_, "glXGetProcAddress", "no glXCreateContextAttribsARB");
    const std::array<int, 7> attributes{
        GLX_CONTEXT_MAJOR_VERSION_ARB,    3,   GLX_CONTEXT_MINOR_VERSION_ARB, 2, GLX_CONTEXT_PROFILE_MASK_ARB,
        GLX_CONTEXT_CORE_PROFILE_BIT_ARB, None};
    context_ = create(connection_->get(), config, nullptr, True, attributes.data());
    std::string error = ErrorLog::take(connection_->get());
    if (context_ == nullptr || !error.empty()) {
      if (context_ != nullptr) glXDestroyContext(connection_->get(), context_);
      throw DeviceError(name_, "glXCreateContext", error.empty() ? "no context" : error);
    }
    const std::array<int, 5> one_pixel{GLX_PBUFFER_WIDTH, 1, GLX_PBUFFER_HEIGHT, 1, None};
    surface_ = glXCreatePbuffer(connection_->get(), config, one_pixel.data());
    error = ErrorLog::take(connection_->get());
    if (surface_ == None || !error.empty()) {
      glXDestroyContext(connection_->get(), context_);
      throw DeviceError(name_, "glXCreatePbuffer", error.empty() ? "no surface" : error);
    }
  }
  ~GlxContext() override {
    if (is_current()) glXMakeContextCurrent(connection_->get(), None, None, nullptr);
    glXDestroyPbuffer(connection_->get(), surface_);
    glXDestroyContext(connection_->get(), context_);
  }
  void make_current() override {
    const bool is_done = glXMakeContextCurrent(connection_->get(), surface_, surface_, context_) == True;
    const std::string error = ErrorLog::take(connection_->get());
    if (!is_done || !error.empty()) {
      throw DeviceError(name_, "glXMakeContextCurrent", error.empty() ? "failure" : error);
    }
  }
  [[nodiscard]] bool is_current() const override { return glXGetCurrentContext() == context_; }

 private:
  std::shared_ptr<const Connection> connection_;
  std::string name_;
  GLXContext context_ = nullptr;
  GLXPbuffer surface_ = None;
};

class X11Platform : public GlPlatform {
 public:
  X11Platform()
      : connection_(std::make_shared<const Connection>()),
        name_("X server " + std::string(XDisplayString(connection_->get()))) {
    Display* display = connection_->get();
    int major = 0;
    int minor = 0;
    if (glXQueryVersion(display, &major, &minor) == False || (major == 1 && minor < 3)) {
      throw DeviceError(name_, "glXQueryVersion", "no GLX 1.3");
    }
    // Double-buffered, because Mesa would send a single buffer to the server whenever it is flushed.
    const std::array<int, 15> attributes{GLX_DRAWABLE_TYPE,
                                         GLX_PBUFFER_BIT,
                                         GLX_RENDER_TYPE,
                                         GLX_RGBA_BIT,
                                         GLX_RED_SIZE,
                                         8,
                                         GLX_GREEN_SIZE,
                                         8,
                                         GLX_BLUE_SIZE,
                                         8,
                                         GLX_ALPHA_SIZE,
                                         8,
                                         GLX_DOUBLEBUFFER,
                                         False,
                                         None};
    int count = 0;
    GLXFBConfig* configs = glXChooseFBConfig(display, DefaultScreen(display), attributes.data(), &count);
    if (configs != nullptr && count > 0) config_ = configs[0];
    if (configs != nullptr) XFree(configs);
    if (config_ == nullptr) throw DeviceError(name_, "glXChooseFBConfig", "no configuration for OpenGL");
  }
  [[nodiscard]] std::unique_ptr<GlContext> make_context() const override {
    return std::make_unique<GlxContext>(connection_, config_, name_);
  }
  [[nodiscard]] std::string name() const override { return name_; }

 private:
  std::shared_ptr<const Connection> connection_;
  std::string name_;
  GLXFBConfig config_ = nullptr;
};

}  // namespace

std::shared_ptr<GlPlatform> open_x11(std::vector<std::string>& failures, GlDriver& driver) {
  try {
    auto platform = std::make_shared<X11Platform>();
    driver = proven_driver(*platform);
    return platform;
  } catch (const DeviceError& error) {
    failures.emplace_back(error.what());
    return nullptr;
  }
}

}  // namespace gdtslam
