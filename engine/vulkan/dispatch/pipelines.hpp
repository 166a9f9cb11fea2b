// A compute pipeline per variant of a kernel, made when it is first used.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "pipeline_cache.hpp"
#include "shader_table.hpp"

namespace gdtslam {

struct VariantPipeline {
  vk::raii::DescriptorSetLayout set_layout{nullptr};
  vk::raii::PipelineLayout layout{nullptr};
  vk::raii::Pipeline pipeline{nullptr};
};

/// What a binding of a variant is.
vk::DescriptorType descriptor_type(const ShaderVariant& variant, std::size_t binding);

/// Every call within a DriverCalls::Scope.
class Pipelines {
 public:
  Pipelines(const Device& device, const VulkanOptions& options);

  /// The variant that serves a launch; throws Error when the kernel has none.
  const ShaderVariant& variant_for(const KernelInfo& kernel, const LaunchShape& shape);
  const VariantPipeline& pipeline_of(const KernelInfo& kernel, const ShaderVariant& variant);
  [[nodiscard]] const PipelineCache& cache() const { return cache_; }
  /// Pipelines made so far.
  [[nodiscard]] std::uint64_t made() const { return made_; }

 private:
  VariantPipeline make(const KernelInfo& kernel, const ShaderVariant& variant);
  vk::raii::ShaderModule make_module(const ShaderVariant& variant);

  const Device& device_;
  ShaderVariants preference_;
  std::function<void(std::string_view, std::vector<std::uint32_t>&)> edit_shader_;
  PipelineCache cache_;
  std::unordered_map<const KernelInfo*, std::span<const ShaderVariant>> variants_;
  std::unordered_map<const ShaderVariant*, VariantPipeline> pipelines_;
  std::uint64_t made_ = 0;
};

}  // namespace gdtslam
