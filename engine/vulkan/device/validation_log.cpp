#include "validation_log.hpp"

#include <exception>
#include <utility>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kLoaderMessage = "Loader Message";  // the id of all that the loader says

}  // namespace

bool counts_as_fault(vk::DebugUtilsMessageSeverityFlagBitsEXT severity, vk::DebugUtilsMessageTypeFlagsEXT types,
                     std::string_view id_name) {
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
  if (id_name == kLoaderMessage) {
    return false;
  }
  const bool is_general = !(types & (Type::eValidation | Type::ePerformance));
  return severity == Severity::eError || (severity == Severity::eWarning && !is_general);
}

std::string ValidationLog::take() {
  std::string text;
  for (const std::string& message : std::exchange(messages_, {})) {
    text += (text.empty() ? "" : " | ") + message;
  }
  return text;
}

void ValidationLog::hand_out() noexcept {
  if (messages_.empty()) {
    return;
  }
  if (on_message_) {
    for (const std::string& message : std::exchange(messages_, {})) {
      on_message_(message);
    }
    return;
  }
  // No caller can be told by an exception, and validation is asked for to see such faults: the runtime names this one.
  try {
    throw DeviceError("vulkan", "validation at the end of a backend", take());
  } catch (...) {
    std::terminate();
  }
}

}  // namespace gdtslam
