// OpenGL without a display: a surfaceless EGL context, else EGL on a device or the default display; neither X nor a GPU
// is needed. VTK is used only after one of them works, because Debian's VTK ends the process if it gets no window
// without X. A context and the objects that draw with it belong to one thread.
#pragma once

#include <memory>
#include <string>

namespace gdtslam {

/// OpenGL without a display.
class GraphicsContext {
 public:
  /// Throws UnavailableError (exit 69) if nothing can draw. Its single line lists the attempts, the reason of each
  /// failure, and what to install or run.
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
