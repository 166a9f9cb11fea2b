// OpenGL without a display: a surfaceless EGL context, else EGL on a device or the default display; no X and no GPU
// needed. VTK is not touched before one of them is known to work, because Debian's VTK ends the process when it is
// asked for a window without X. A context and the objects that draw with it belong to one thread.
#pragma once

#include <memory>
#include <string>

namespace gdtslam {

/// OpenGL without a display.
class GraphicsContext {
 public:
  /// Throws UnavailableError (exit 69) if nothing can draw. Its one line lists the attempts, the reason why each
  /// failed, and what to install or run.
  GraphicsContext();
  ~GraphicsContext();
  GraphicsContext(const GraphicsContext&) = delete;
  GraphicsContext& operator=(const GraphicsContext&) = delete;

  /// Names the interface and the renderer: "EGL, llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5".
  [[nodiscard]] std::string description() const;

  struct State;
  [[nodiscard]] State& state() const { return *state_; }  ///< for the viewer's own sources

 private:
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
