#include "pipelines.hpp"

#include <algorithm>
#include <array>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>

#include "buffers.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

glm::uvec3 vector_of(const std::array<std::uint32_t, 3>& values) { return {values[0], values[1], values[2]}; }

std::string to_text(const glm::uvec3& v) {
  return std::to_string(v.x) + " x " + std::to_string(v.y) + " x " + std::to_string(v.z);
}

/// Whether a device can run work groups of that size.
bool fits(const Device& device, const glm::uvec3& local_size) {
  const glm::uvec3 most = vector_of(device.properties().limits.maxComputeWorkGroupSize);
  const std::uint64_t invocations = std::uint64_t{local_size.x} * local_size.y * local_size.z;
  return glm::all(glm::lessThanEqual(local_size, most)) && invocations <= device.info().max_group_invocations;
}

/// Whether the device takes what the form reads as texels, and they are wanted.
bool has_texels(const FormContext& context, const ShaderForm& form) {
  if (form.texel_binding < 0) {
    return true;
  }
  const std::size_t bytes = context.shape.buffer_bytes[static_cast<std::size_t>(form.texel_binding)];
  const std::size_t words = padded_size(bytes) / sizeof(std::uint32_t);
  return context.preference != ShaderForms::kNoTexels && words <= context.device.max_texel_words;
}

/// The values of the specialisation constants and where they stand; a shader takes those that it has.
struct Specialization {
  std::array<std::uint32_t, 5> values;
  std::array<vk::SpecializationMapEntry, 5> entries;
  vk::SpecializationInfo info;
  explicit Specialization(const ShaderForm& form)
      : values{form.local_size[0], form.local_size[1], form.local_size[2], form.constants[0], form.constants[1]} {
    constexpr std::array<std::uint32_t, 5> kIds{0, 1, 2, 10, 11};
    for (std::uint32_t i = 0; i < kIds.size(); ++i) {
      entries[i] = vk::SpecializationMapEntry(kIds[i], i * 4, 4);
    }
    info = vk::SpecializationInfo(static_cast<std::uint32_t>(entries.size()), entries.data(), sizeof(values),
                                  values.data());
  }
  Specialization(const Specialization&) = delete;
  Specialization& operator=(const Specialization&) = delete;
  ~Specialization() = default;
};

}  // namespace

vk::DescriptorType descriptor_type(const ShaderForm& form, std::size_t binding) {
  if (form.uniform_binding == static_cast<int>(binding)) {
    return vk::DescriptorType::eUniformBuffer;
  }
  return form.texel_binding == static_cast<int>(binding) ? vk::DescriptorType::eUniformTexelBuffer
                                                         : vk::DescriptorType::eStorageBuffer;
}

Pipelines::Pipelines(const Device& device, const VulkanOptions& options)
    : device_(device),
      preference_(options.forms),
      edit_shader_(options.edit_shader),
      cache_(device, options.cache_folder) {}

const ShaderForm& Pipelines::form_for(const KernelInfo& kernel, const LaunchShape& shape) {
  auto found = forms_.find(&kernel);
  if (found == forms_.end()) {
    found = forms_.emplace(&kernel, forms_of(kernel.name)).first;
  }
  if (found->second.empty()) {
    throw Error(ExitCode::kFailed, "kernel " + std::string(kernel.name) + ": this build has no shader for it");
  }
  const FormContext context{device_.info(), preference_, shape};
  for (const ShaderForm& form : found->second) {
    const bool suits = form.suits == nullptr || form.suits(context);
    if (suits && has_texels(context, form) && fits(device_, vector_of(form.local_size))) {
      return form;
    }
  }
  throw DeviceError(device_.info().name, "kernel " + std::string(kernel.name),
                    "no form that fits: its smallest group of " + to_text(vector_of(found->second.back().local_size)) +
                        " invocations exceeds the limits " +
                        to_text(vector_of(device_.properties().limits.maxComputeWorkGroupSize)) + " or " +
                        std::to_string(device_.info().max_group_invocations) + " in all");
}

const FormPipeline& Pipelines::pipeline_of(const KernelInfo& kernel, const ShaderForm& form) {
  auto found = pipelines_.find(&form);
  if (found == pipelines_.end()) {
    found = pipelines_.emplace(&form, make(kernel, form)).first;
    ++made_;
  }
  return found->second;
}

vk::raii::ShaderModule Pipelines::make_module(const ShaderForm& form) {
  std::vector<std::uint32_t> spirv(form.spirv.begin(), form.spirv.end());
  if (edit_shader_) {
    edit_shader_(form.name, spirv);
  }
  vk::ShaderModuleCreateInfo info;
  info.setCode(spirv);
  return {device_.handle(), info};
}

FormPipeline Pipelines::make(const KernelInfo& kernel, const ShaderForm& form) {
  FormPipeline made;
  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  for (std::size_t i = 0; i < kernel.bindings.size(); ++i) {
    bindings.emplace_back(static_cast<std::uint32_t>(i), descriptor_type(form, i), 1,
                          vk::ShaderStageFlagBits::eCompute);
  }
  made.set_layout = vk::raii::DescriptorSetLayout(device_.handle(), vk::DescriptorSetLayoutCreateInfo({}, bindings));

  const vk::PushConstantRange params(vk::ShaderStageFlagBits::eCompute, 0,
                                     push_constant_bytes(form, kernel.params_bytes));
  vk::PipelineLayoutCreateInfo layout({}, *made.set_layout);
  if (params.size > 0) {
    layout.setPushConstantRanges(params);
  }
  made.layout = vk::raii::PipelineLayout(device_.handle(), layout);

  const vk::raii::ShaderModule module = make_module(form);
  const Specialization specialization(form);
  const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main",
                                                &specialization.info);
  made.pipeline =
      vk::raii::Pipeline(device_.handle(), cache_.handle(), vk::ComputePipelineCreateInfo({}, stage, *made.layout));
  return made;
}

}  // namespace gdtslam
