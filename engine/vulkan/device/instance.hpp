// The connection to Vulkan, with the validation layers where they are asked for, and what these say about a backend,
// from the making of its instance to its end.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "api.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

/// Whether a message is a fault of ours: what validation and the search for slow use report from warnings on, and
/// errors of a general kind. `id_name` is the message's own. What the loader says is never one: it speaks, as of
/// errors, of every driver file on the machine that it passes over, and what fails for us shows in the result of our
/// call.
bool counts_as_fault(vk::DebugUtilsMessageSeverityFlagBitsEXT severity, vk::DebugUtilsMessageTypeFlagsEXT types,
                     std::string_view id_name);

/// Warnings and errors, each one text. What nobody has taken by the end is handed out, so none is lost: those of the
/// last objects that are destroyed come when no verb of the backend can throw them any more. Not thread-safe.
class ValidationLog {
 public:
  /// Takes a message that came too late to be thrown; must not throw. Empty: they end the process.
  using Sink = std::function<void(std::string_view message)>;

  explicit ValidationLog(Sink on_message) : on_message_(std::move(on_message)) {}
  ValidationLog(const ValidationLog&) = delete;
  ValidationLog& operator=(const ValidationLog&) = delete;
  ~ValidationLog() { hand_out(); }

  void add(std::string message) { messages_.push_back(std::move(message)); }
  /// All messages so far as one text, "" where there are none; they are then gone from the log.
  [[nodiscard]] std::string take();
  /// Gives what is there to the sink.
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

/// Throws UnavailableError when libvulkan.so.1 is not installed, when there is no driver, when the loader is older than
/// Vulkan 1.2, or when `log` is given (validation and synchronisation validation are wanted) and the layer is not
/// installed. The log must outlive the instance. The library stays open until the process ends, because drivers leave
/// threads and thread-local destructors behind.
VulkanInstance make_instance(ValidationLog* log);

/// The error of a call, which names itself in the exception.
DeviceError device_error(const std::string& device, const vk::SystemError& error);

/// Throws what vk::raii would have thrown, for the calls that are made without it.
void check(VkResult result, const char* call);

}  // namespace gdtslam
