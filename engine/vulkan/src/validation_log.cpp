#include "validation_log.hpp"

#include <cstdio>
#include <cstdlib>
#include <utility>

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
  const std::vector<std::string> messages = std::exchange(messages_, {});
  for (const std::string& message : messages) {
    if (on_message_) {
      on_message_(message);
    } else {
      std::fprintf(stderr, "Vulkan validation, at the end of a backend: %s\n", message.c_str());
    }
  }
  if (!messages.empty() && !on_message_) {
    std::abort();  // validation is asked for to see such faults; no caller could be told by an exception
  }
}

}  // namespace gdtslam
