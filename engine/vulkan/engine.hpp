// All device objects of a backend in the order of creation; they are destroyed in reverse order.
#pragma once

#include "engine/vulkan/commands/barriers.hpp"
#include "engine/vulkan/commands/batches.hpp"
#include "engine/vulkan/device/device.hpp"
#include "engine/vulkan/device/environment.hpp"
#include "engine/vulkan/device/instance.hpp"
#include "engine/vulkan/dispatch/descriptor_sets.hpp"
#include "engine/vulkan/dispatch/pipelines.hpp"
#include "engine/vulkan/memory/buffers.hpp"
#include "engine/vulkan/memory/transfers.hpp"

namespace gdtslam {

struct VulkanEngine {
  explicit VulkanEngine(const VulkanOptions& options)
      : log(options.on_message),
        instance(make_instance(options.validation ? &log : nullptr)),
        device(instance, options),
        batches(device, options.wait_limit_s.value_or(kWaitLimit_s),
                options.spin_s.value_or(device.info().is_hardware() ? kSpin_s : 0.0)),
        buffers(device),
        pipelines(device, options),
        sets(device),
        transfers(device, batches, barriers) {}
  VulkanEngine(const VulkanEngine&) = delete;
  VulkanEngine& operator=(const VulkanEngine&) = delete;
  ~VulkanEngine() = default;

  ValidationLog log;  ///< receives messages while all others are destroyed
  VulkanInstance instance;
  Device device;
  BarrierTracker barriers;
  Batches batches;
  Buffers buffers;
  Pipelines pipelines;
  DescriptorSets sets;
  Transfers transfers;
};

}  // namespace gdtslam
