// Ways to a context of desktop OpenGL 3.2 (core) or newer without a window on a screen. A context has a surface of its
// own and belongs to the thread that makes it current.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/viewer/graphics.hpp"

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

/// An opened driver that has been seen to work. Thread-safe.
struct GlPlatform {
  std::string name;  ///< "EGL (surfaceless)"
  /// A new context, not current yet. Throws DeviceError.
  std::function<std::unique_ptr<GlContext>()> make_context;
  std::string renderer{};  ///< "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string version{};   ///< "4.5"
};

struct GraphicsContext::State {
  GlPlatform platform;
};

/// The first platform of EGL whose context works, or none; what fails is added to `failures`, one phrase each.
std::optional<GlPlatform> open_egl(std::vector<std::string>& failures);

/// Makes a context of the platform, loads OpenGL's functions in it and asks the driver what it is. Throws DeviceError
/// where any of that fails or OpenGL is older than 3.2.
void prove(GlPlatform& platform);
/// Loads OpenGL's functions for the current context; what failed, or an empty text.
std::string load_gl_functions();

}  // namespace gdtslam
