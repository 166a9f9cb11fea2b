// Contexts of desktop OpenGL 3.2 (core) or newer without a window on a screen, through EGL [Khronos, EGL 1.5]. A
// context belongs to the thread that makes it current.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/viewer/graphics.hpp"

namespace gdtslam {

/// An opened display and the properties of its contexts; EGL's handles are pointers, so that its headers stay out of
/// here. Displays stay open until the process ends.
struct GlDisplay {
  std::string name;  ///< "EGL (surfaceless)"
  void* display = nullptr;
  void* config = nullptr;
  bool has_surface = false;  ///< each context has a surface of one pixel
  std::string renderer{};    ///< "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string version{};     ///< "4.5"
};

struct GraphicsContext::State {
  GlDisplay display;
};

class GlContext {
 public:
  /// Throws DeviceError, like make_current().
  explicit GlContext(const GlDisplay& display);
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;
  void make_current();
  [[nodiscard]] bool is_current() const;

 private:
  std::string name_;
  void* display_;
  void* context_ = nullptr;
  void* surface_ = nullptr;
};

/// Loads OpenGL's functions for the current context. Returns the failure, or an empty text.
std::string load_gl_functions();

// Messages of VTK. After the first GraphicsContext none of them reaches the terminal: each thread's errors are kept
// until a view asks for them; warnings are dropped.

/// Replaces VTK's own output and ends its log of events; has an effect once per process.
void collect_vtk_messages();

/// One line for each error in this thread since the last call.
std::vector<std::string> take_vtk_errors();

}  // namespace gdtslam
