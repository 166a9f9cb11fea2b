#include "render_window.hpp"

namespace gdtslam {

RenderWindow* RenderWindow::New() {
  auto* window = new RenderWindow;
  window->InitializeObjectBase();
  return window;
}

RenderWindow::RenderWindow() {
  this->SetMultiSamples(0);
  this->SetAlphaBitPlanes(1);
  this->SetShowWindow(false);
  this->SetUseOffScreenBuffers(true);  // the picture is read from a framebuffer object, never copied to the surface
  this->SetSupportsOpenGL(1);
  this->SetIsDirect(1);
}

// As VTK's own, but for the one code of glewInit that says "no X display" after everything was loaded.
void RenderWindow::OpenGLInitContext() {
  this->ContextCreationTime.Modified();
  if (this->Initialized) return;
  loading_failure_ = load_gl_functions();
  this->GlewInitValid = loading_failure_.empty();
  this->Initialized = this->GlewInitValid;
}

void RenderWindow::MakeCurrent() {
  if (context_ != nullptr && !context_->is_current()) context_->make_current();
}

bool RenderWindow::IsCurrent() { return context_ != nullptr && context_->is_current(); }

}  // namespace gdtslam
