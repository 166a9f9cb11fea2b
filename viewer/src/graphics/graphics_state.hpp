// What a GraphicsContext keeps, for the viewer's own sources.
#pragma once

#include "gdtslam/viewer/graphics.hpp"
#include "graphics/gl_platform.hpp"

namespace gdtslam {

struct GraphicsContext::State {
  std::shared_ptr<GlPlatform> platform;
  GlDriver driver;
  std::string fallback;  ///< why the first choice was not used
};

}  // namespace gdtslam
