// VTK's window upon a context of ours: no window system, nothing on a screen; pictures are read from its framebuffer.
#pragma once

#include <vtkGenericOpenGLRenderWindow.h>

#include <string>

#include "gl_platform.hpp"

namespace gdtslam {

class RenderWindow : public vtkGenericOpenGLRenderWindow {
 public:
  static RenderWindow* New();

  /// The context must outlive the window.
  void set_context(GlContext* context) { context_ = context; }
  /// Why OpenGL's functions could not be loaded; empty where they were.
  [[nodiscard]] const std::string& loading_failure() const { return loading_failure_; }

  void OpenGLInitContext() override;
  void MakeCurrent() override;
  bool IsCurrent() override;
  int SupportsOpenGL() override { return 1; }
  vtkTypeBool IsDirect() override { return 1; }

 protected:
  RenderWindow();
  ~RenderWindow() override = default;

 private:
  GlContext* context_ = nullptr;
  std::string loading_failure_;
};

}  // namespace gdtslam
