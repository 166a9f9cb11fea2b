// The connection to Vulkan, with validation layers on request, and their messages about a backend over the whole life
// of its instance.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "api.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

/// Whether a message is a fault of ours: validation and performance messages from warnings on, and general errors.
/// `id_name` is the message's own. Messages of the loader never count: it reports every driver file that it skips as an
/// error, and our own failures show in the results of our calls.
bool counts_as_fault(vk::DebugUtilsMessageSeverityFlagBitsEXT severity, vk::DebugUtilsMessageTypeFlagsEXT types,
                     std::string_view id_name);

/// Collects warnings and errors as text. The destructor passes the rest to the sink, so none is lost: messages about
/// the last destroyed objects come after the last call that could throw them. Not thread-safe.
class ValidationLog {
 public:
  /// Receives a message that came too late to be thrown; must not throw. Empty: such messages end the process.
  using Sink = std::function<void(std::string_view message)>;

  explicit ValidationLog(Sink on_message) : on_message_(std::move(on_message)) {}
  ValidationLog(const ValidationLog&) = delete;
  ValidationLog& operator=(const ValidationLog&) = delete;
  ~ValidationLog() { hand_out(); }

  void add(std::string message) { messages_.push_back(std::move(message)); }
  /// Removes all messages and returns them as one text, "" if there are none.
  [[nodiscard]] std::string take();
  /// Passes the messages to the sink.
  void hand_out() noexcept;

 private:
  Sink on_message_;
  std::vector<std::string> messages_;
};

struct VulkanInstance {
  vk::raii::Context context;
  vk::raii::Instance handle;
  vk::raii::DebugUtilsMessengerEXT messenger;
};

/// Throws UnavailableError if libvulkan.so.1 or a driver is missing, if the loader is older than Vulkan 1.2, or if
/// `log` is given (which enables validation and synchronisation validation) and the layer is missing. The log must
/// outlive the instance. The library stays open until the process ends, because drivers leave threads and thread-local
/// destructors behind.
VulkanInstance make_instance(ValidationLog* log);

/// The error of a call, with the call's name.
DeviceError device_error(const std::string& device, const vk::SystemError& error);

/// Throws like vk::raii, for calls made without it.
void check(VkResult result, const char* call);

}  // namespace gdtslam
