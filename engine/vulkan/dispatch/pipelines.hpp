// A compute pipeline per variant of a kernel, created on first use, and the cache of the driver's compiled code.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "engine/vulkan/device/device.hpp"
#include "shader_table.hpp"

namespace gdtslam {

/// The driver's compiled pipelines, kept between runs: a file per device and driver. It is checked before use, and
/// ignored if it is damaged or foreign.
class PipelineCache {
 public:
  /// With an empty folder nothing is read or written.
  PipelineCache(const Device& device, const std::string& folder);

  [[nodiscard]] const vk::raii::PipelineCache& handle() const { return handle_; }
  [[nodiscard]] bool was_loaded() const { return was_loaded_; }
  /// Writes a new file under another name and renames it. False on failure.
  [[nodiscard]] bool save() const;

 private:
  std::string path_;
  bool was_loaded_ = false;
  vk::raii::PipelineCache handle_;
};

struct VariantPipeline {
  vk::raii::DescriptorSetLayout set_layout{nullptr};
  vk::raii::PipelineLayout layout{nullptr};
  vk::raii::Pipeline pipeline{nullptr};
};

class Pipelines {
 public:
  Pipelines(const Device& device, const VulkanOptions& options);

  /// The variant for a launch; throws Error if the kernel has none.
  const ShaderVariant& variant_for(const KernelInfo& kernel, const LaunchShape& shape);
  const VariantPipeline& find_pipeline(const KernelInfo& kernel, const ShaderVariant& variant);
  [[nodiscard]] const PipelineCache& cache() const { return cache_; }
  /// Number of pipelines created.
  [[nodiscard]] std::uint64_t made() const { return made_; }

 private:
  VariantPipeline make(const KernelInfo& kernel, const ShaderVariant& variant);
  vk::raii::ShaderModule make_module(const ShaderVariant& variant);

  const Device& device_;
  std::function<void(std::string_view, std::vector<std::uint32_t>&)> edit_shader_;
  PipelineCache cache_;
  std::unordered_map<const KernelInfo*, std::span<const ShaderVariant>> variants_;
  std::unordered_map<const ShaderVariant*, VariantPipeline> pipelines_;
  std::uint64_t made_ = 0;
};

}  // namespace gdtslam
