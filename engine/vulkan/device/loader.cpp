#include "loader.hpp"

#include <dlfcn.h>

#include "gdtslam/core/error.hpp"

namespace gdtslam {

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

}  // namespace gdtslam
