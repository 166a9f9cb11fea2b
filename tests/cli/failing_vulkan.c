// Stands in for the Vulkan loader (libvulkan.so.1) and passes every call on to the real one, whose path is in
// FAILING_VULKAN_REAL, but lets the call number FAILING_VULKAN_AT (from 1) of the function FAILING_VULKAN_CALL and all
// after it fail: with VK_ERROR_DEVICE_LOST, or VK_ERROR_OUT_OF_DEVICE_MEMORY where it allocates.
#include <dlfcn.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef void (*Function)(void);
typedef Function (*GetProcAddr)(void*, const char*);
typedef int32_t (*Call)(void*, uintptr_t, const void*, void*);  // the shape of all three

enum { kOutOfDeviceMemory = -2, kDeviceLost = -4 };

static GetProcAddr g_device_address;
static Call g_create_device, g_allocate_memory, g_queue_submit;

static int is_failing(const char* name) {
  static long calls = 0;
  const char* const failing = getenv("FAILING_VULKAN_CALL");
  const char* const at = getenv("FAILING_VULKAN_AT");
  if (failing == NULL || strcmp(failing, name) != 0) return 0;
  return ++calls >= (at == NULL ? 1 : atol(at));
}

static int32_t create_device(void* device, uintptr_t info, const void* allocator, void* result) {
  return is_failing("vkCreateDevice") ? kDeviceLost : g_create_device(device, info, allocator, result);
}

static int32_t allocate_memory(void* device, uintptr_t info, const void* allocator, void* result) {
  return is_failing("vkAllocateMemory") ? kOutOfDeviceMemory : g_allocate_memory(device, info, allocator, result);
}

static int32_t queue_submit(void* queue, uintptr_t count, const void* submits, void* fence) {
  return is_failing("vkQueueSubmit") ? kDeviceLost : g_queue_submit(queue, count, submits, fence);
}

static Function device_address(void* device, const char* name);

// Ours in place of the three calls; what is passed on is remembered.
static Function replaced(const char* name, Function real) {
  if (real == NULL) return real;
  if (strcmp(name, "vkCreateDevice") == 0) return g_create_device = (Call)real, (Function)create_device;
  if (strcmp(name, "vkAllocateMemory") == 0) return g_allocate_memory = (Call)real, (Function)allocate_memory;
  if (strcmp(name, "vkQueueSubmit") == 0) return g_queue_submit = (Call)real, (Function)queue_submit;
  if (strcmp(name, "vkGetDeviceProcAddr") == 0) return g_device_address = (GetProcAddr)real, (Function)device_address;
  return real;
}

static Function device_address(void* device, const char* name) { return replaced(name, g_device_address(device, name)); }

// NOLINTNEXTLINE(readability-identifier-naming): the loader's name
__attribute__((visibility("default"))) Function vkGetInstanceProcAddr(void* instance, const char* name) {
  static GetProcAddr real = NULL;
  if (real == NULL) {
    const char* const path = getenv("FAILING_VULKAN_REAL");
    void* const loader = path == NULL ? NULL : dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (loader == NULL) return NULL;
    real = (GetProcAddr)dlsym(loader, "vkGetInstanceProcAddr");
    if (real == NULL) return NULL;
  }
  return replaced(name, real(instance, name));
}
