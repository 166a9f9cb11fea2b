#include "errors.hpp"

namespace gdtslam {

void check(VkResult result, const char* call) {
  if (result != VK_SUCCESS) {
    throw vk::SystemError(vk::make_error_code(static_cast<vk::Result>(result)), call);
  }
}

}  // namespace gdtslam
