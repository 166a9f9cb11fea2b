// Ways to an OpenGL context without a window on a screen. A GlPlatform is an opened driver or X server that has been
// seen to work; it makes contexts of desktop OpenGL 3.2 (core) or newer, each with a surface of its own. Platforms are
// thread-safe; a context belongs to the thread that makes it current.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace gdtslam {

class GlContext {
 public:
  GlContext() = default;
  virtual ~GlContext() = default;
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;
  /// Throws DeviceError.
  virtual void make_current() = 0;
  [[nodiscard]] virtual bool is_current() const = 0;
};

class GlPlatform {
 public:
  GlPlatform() = default;
  virtual ~GlPlatform() = default;
  GlPlatform(const GlPlatform&) = delete;
  GlPlatform& operator=(const GlPlatform&) = delete;
  /// A new context, not current yet. Throws DeviceError.
  [[nodiscard]] virtual std::unique_ptr<GlContext> make_context() const = 0;
  /// "EGL (surfaceless)".
  [[nodiscard]] virtual std::string name() const = 0;
};

/// What an OpenGL driver says of itself.
struct GlDriver {
  std::string renderer;  ///< "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string version;   ///< "4.5"
};

/// The first platform of EGL whose context works, or none; what fails is added to `failures`, one phrase each.
std::shared_ptr<GlPlatform> open_egl(std::vector<std::string>& failures, GlDriver& driver);

/// Makes a context of the platform, loads OpenGL's functions in it and asks the driver what it is. Throws DeviceError
/// where any of that fails or OpenGL is older than 3.2.
GlDriver proven_driver(const GlPlatform& platform);
/// Loads OpenGL's functions for the current context; what failed, or an empty text.
std::string load_gl_functions();

}  // namespace gdtslam
