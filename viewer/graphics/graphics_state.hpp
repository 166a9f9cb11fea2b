// What a GraphicsContext keeps, for the viewer's own sources.
#pragma once

#include "gdtslam/viewer/graphics.hpp"
#include "gl_platform.hpp"

namespace gdtslam {

struct GraphicsContext::State {
  std::shared_ptr<GlPlatform> platform;
  GlDriver driver;
};

}  // namespace gdtslam
