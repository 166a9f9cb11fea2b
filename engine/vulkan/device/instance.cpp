#include "instance.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <exception>

namespace gdtslam {
namespace {

constexpr std::string_view kLoaderMessage = "Loader Message";  // the id of all messages of the loader
constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
constexpr std::uint32_t kApiVersion = VK_API_VERSION_1_2;

VKAPI_ATTR VkBool32 VKAPI_CALL keep_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                            VkDebugUtilsMessageTypeFlagsEXT types,
                                            const VkDebugUtilsMessengerCallbackDataEXT* data, void* log) {
  if (counts_as_fault(static_cast<vk::DebugUtilsMessageSeverityFlagBitsEXT>(severity),
                      vk::DebugUtilsMessageTypeFlagsEXT(types),
                      data->pMessageIdName == nullptr ? "" : data->pMessageIdName)) {
    static_cast<ValidationLog*>(log)->add(data->pMessage);
  }
  return VK_FALSE;
}

vk::DebugUtilsMessengerCreateInfoEXT messenger_info(ValidationLog* log) {
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
  vk::DebugUtilsMessengerCreateInfoEXT info;
  info.messageSeverity = Severity::eWarning | Severity::eError;
  info.messageType = Type::eGeneral | Type::eValidation | Type::ePerformance;
  info.pfnUserCallback = &keep_message;
  info.pUserData = log;
  return info;
}

void require_validation_layer(const vk::raii::Context& context) {
  const std::vector<vk::LayerProperties> layers = context.enumerateInstanceLayerProperties();
  const bool found = std::any_of(layers.begin(), layers.end(), [](const vk::LayerProperties& layer) {
    return std::string_view(layer.layerName) == kValidationLayer;
  });
  if (!found) {
    throw UnavailableError(
        "the Vulkan validation layer is asked for and not installed (Debian package vulkan-validationlayers)");
  }
}

void require_version(const vk::raii::Context& context) {
  // A loader of Vulkan 1.0 lacks the function.
  const bool is_known = context.getDispatcher()->vkEnumerateInstanceVersion != nullptr;
  const std::uint32_t version = is_known ? context.enumerateInstanceVersion() : VK_API_VERSION_1_0;
  if (version < kApiVersion) {
    throw UnavailableError("the Vulkan loader offers version " + std::to_string(VK_API_VERSION_MAJOR(version)) + "." +
                           std::to_string(VK_API_VERSION_MINOR(version)) + ", 1.2 is needed");
  }
}

PFN_vkGetInstanceProcAddr vulkan_entry() {
  void* library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    throw UnavailableError(
        "the Vulkan loader libvulkan.so.1 cannot be opened; install it (Debian package libvulkan1) or use the CPU");
  }
  const auto entry = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library, "vkGetInstanceProcAddr"));
  if (entry == nullptr) {
    throw UnavailableError("libvulkan.so.1 has no vkGetInstanceProcAddr, so it is no Vulkan loader");
  }
  return entry;
}

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
  // No caller is left to catch an exception, and validation is meant to show such faults: the runtime prints this one.
  try {
    throw DeviceError("vulkan", "validation at the end of a backend", take());
  } catch (...) {
    std::terminate();
  }
}

VulkanInstance make_instance(ValidationLog* log) {
  vk::raii::Context context(vulkan_entry());
  require_version(context);
  vk::ApplicationInfo application;
  application.pApplicationName = "gdtslam";
  application.apiVersion = kApiVersion;
  vk::InstanceCreateInfo info;
  info.pApplicationInfo = &application;

  const std::array wanted{vk::ValidationFeatureEnableEXT::eSynchronizationValidation};
  const std::array extensions{VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  vk::DebugUtilsMessengerCreateInfoEXT messages = messenger_info(log);
  vk::ValidationFeaturesEXT features;
  if (log != nullptr) {
    require_validation_layer(context);
    features.setEnabledValidationFeatures(wanted);
    features.pNext = &messages;  // watches the creation of the instance, too
    info.setPEnabledExtensionNames(extensions);
    info.setPEnabledLayerNames(kValidationLayer);
    info.pNext = &features;
  }
  try {
    vk::raii::Instance instance = context.createInstance(info);
    vk::raii::DebugUtilsMessengerEXT messenger{nullptr};
    if (log != nullptr) {
      messenger = instance.createDebugUtilsMessengerEXT(messages);
    }
    return {std::move(context), std::move(instance), std::move(messenger)};
  } catch (const vk::IncompatibleDriverError&) {
    throw UnavailableError(
        "Vulkan finds no driver on this machine that loads; install one (Debian package mesa-vulkan-drivers, or the "
        "maker's), see with VK_LOADER_DEBUG=error in the environment why one that is installed does not load, or use "
        "the CPU");
  }
}

DeviceError device_error(const std::string& device, const vk::SystemError& error) {
  const std::string text = error.what();  // CALL: RESULT
  return {device, text.substr(0, text.rfind(": ")), vk::to_string(static_cast<vk::Result>(error.code().value()))};
}

void check(VkResult result, const char* call) {
  if (result != VK_SUCCESS) {
    throw vk::SystemError(vk::make_error_code(static_cast<vk::Result>(result)), call);
  }
}

}  // namespace gdtslam
