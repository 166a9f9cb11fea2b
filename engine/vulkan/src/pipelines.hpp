// A compute pipeline per form of a kernel, made when it is first used.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "pipeline_cache.hpp"
#include "shader_table.hpp"

namespace gdtslam {

struct FormPipeline {
  vk::raii::DescriptorSetLayout set_layout{nullptr};
  vk::raii::PipelineLayout layout{nullptr};
  vk::raii::Pipeline pipeline{nullptr};
};

/// What a binding of a form is.
vk::DescriptorType descriptor_type(const ShaderForm& form, std::size_t binding);

/// Every call within a DriverCalls::Scope.
class Pipelines {
 public:
  Pipelines(const Device& device, const VulkanOptions& options);

  /// The form that serves a launch; throws Error when the kernel has none.
  const ShaderForm& form_for(const KernelInfo& kernel, const LaunchShape& shape);
  const FormPipeline& pipeline_of(const KernelInfo& kernel, const ShaderForm& form);
  [[nodiscard]] const PipelineCache& cache() const { return cache_; }
  /// Pipelines made so far.
  [[nodiscard]] std::uint64_t made() const { return made_; }

 private:
  FormPipeline make(const KernelInfo& kernel, const ShaderForm& form);
  vk::raii::ShaderModule make_module(const ShaderForm& form);

  const Device& device_;
  ShaderForms preference_;
  std::function<void(std::string_view, std::vector<std::uint32_t>&)> edit_shader_;
  PipelineCache cache_;
  std::unordered_map<const KernelInfo*, std::span<const ShaderForm>> forms_;
  std::unordered_map<const ShaderForm*, FormPipeline> pipelines_;
  std::uint64_t made_ = 0;
};

}  // namespace gdtslam
