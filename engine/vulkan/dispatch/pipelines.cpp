#include "pipelines.hpp"

#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

/// Our header before the driver's data, because a driver may crash on a damaged file.
struct FileHeader {
  std::array<char, 8> magic{'G', 'D', 'T', 'P', 'I', 'P', 'E', '1'};
  std::uint64_t bytes = 0;
  std::uint64_t hash = 0;
};

/// A larger file is not our cache.
constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20U;

/// FNV-1a.
std::uint64_t hash_bytes(std::span<const std::uint8_t> data) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const std::uint8_t byte : data) {
    hash = (hash ^ byte) * 1099511628211ULL;
  }
  return hash;
}

std::string file_name(const vk::PhysicalDeviceProperties& properties) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string name = "pipelines-";
  for (const std::uint8_t byte : properties.pipelineCacheUUID) {
    name += kDigits[byte >> 4U];
    name += kDigits[byte & 15U];
  }
  return name + "-" + std::to_string(properties.vendorID) + "-" + std::to_string(properties.deviceID) + "-" +
         std::to_string(properties.driverVersion) + "-gdtslam";
}

/// Whether the driver's own header names this device.
bool is_for(const vk::PhysicalDeviceProperties& properties, const std::vector<std::uint8_t>& data) {
  VkPipelineCacheHeaderVersionOne header;
  if (data.size() < sizeof(header)) {
    return false;
  }
  std::memcpy(&header, data.data(), sizeof(header));
  return header.headerSize >= sizeof(header) && header.headerVersion == VK_PIPELINE_CACHE_HEADER_VERSION_ONE &&
         header.vendorID == properties.vendorID && header.deviceID == properties.deviceID &&
         std::memcmp(header.pipelineCacheUUID, properties.pipelineCacheUUID.data(), VK_UUID_SIZE) == 0;
}

/// The driver's data from a file; empty if there is no valid one.
std::vector<std::uint8_t> read_file(const std::string& path, const vk::PhysicalDeviceProperties& properties) {
  std::ifstream file(path, std::ios::binary);
  FileHeader header;
  if (!file.read(reinterpret_cast<char*>(&header), sizeof(header)) || header.magic != FileHeader{}.magic ||
      header.bytes > kMostBytes) {
    return {};
  }
  std::error_code error;
  if (fs::file_size(path, error) != sizeof(header) + header.bytes || error) {
    return {};
  }
  std::vector<std::uint8_t> data(header.bytes);
  if (!file.read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(data.size())) ||
      hash_bytes(data) != header.hash || !is_for(properties, data)) {
    return {};
  }
  return data;
}

bool write_file(const std::string& path, const std::vector<std::uint8_t>& data) {
  std::error_code error;
  fs::create_directories(fs::path(path).parent_path(), error);
  const std::string temporary = path + "." + std::to_string(getpid()) + ".part";
  FileHeader header;
  header.bytes = data.size();
  header.hash = hash_bytes(data);
  bool is_written = false;
  {
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(&header), sizeof(header));
    file.write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
    file.close();
    is_written = static_cast<bool>(file);
  }
  if (is_written) {
    fs::rename(temporary, path, error);
    is_written = !error;
  }
  if (!is_written) {
    fs::remove(temporary, error);
  }
  return is_written;
}

}  // namespace

PipelineCache::PipelineCache(const Device& device, const std::string& folder)
    : path_(folder.empty() ? "" : folder + "/" + file_name(device.properties())), handle_(nullptr) {
  std::vector<std::uint8_t> data;
  if (!path_.empty()) {
    data = read_file(path_, device.properties());
  }
  was_loaded_ = !data.empty();
  vk::PipelineCacheCreateInfo info;
  info.initialDataSize = data.size();
  info.pInitialData = data.data();
  handle_ = vk::raii::PipelineCache(device.handle(), info);
}

bool PipelineCache::save() const { return path_.empty() || write_file(path_, handle_.getData()); }

namespace {

glm::uvec3 to_vector(const std::array<std::uint32_t, 3>& values) { return {values[0], values[1], values[2]}; }

std::string to_text(const glm::uvec3& v) {
  return std::to_string(v.x) + " x " + std::to_string(v.y) + " x " + std::to_string(v.z);
}

/// Whether a device can run work groups of that size.
bool fits(const Device& device, const glm::uvec3& local_size) {
  const glm::uvec3 most = to_vector(device.properties().limits.maxComputeWorkGroupSize);
  const std::uint64_t invocations = std::uint64_t{local_size.x} * local_size.y * local_size.z;
  return glm::all(glm::lessThanEqual(local_size, most)) && invocations <= device.info().max_group_invocations;
}

/// Values and offsets of the specialisation constants; a shader uses those that it has.
struct Specialization {
  std::array<std::uint32_t, 5> values;
  std::array<vk::SpecializationMapEntry, 5> entries;
  vk::SpecializationInfo info;
  explicit Specialization(const ShaderVariant& variant)
      : values{variant.local_size[0], variant.local_size[1], variant.local_size[2], variant.constants[0],
               variant.constants[1]} {
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

Pipelines::Pipelines(const Device& device, const VulkanOptions& options)
    : device_(device), edit_shader_(options.edit_shader), cache_(device, options.cache_folder) {}

const ShaderVariant& Pipelines::variant_for(const KernelInfo& kernel, const LaunchShape& shape) {
  auto found = variants_.find(&kernel);
  if (found == variants_.end()) {
    found = variants_.emplace(&kernel, find_variants(kernel.name)).first;
  }
  if (found->second.empty()) {
    throw Error(ExitCode::kFailed, "kernel " + std::string(kernel.name) + ": this build has no shader for it");
  }
  const VariantContext context{device_.info(), shape};
  for (const ShaderVariant& variant : found->second) {
    const bool suits = variant.suits == nullptr || variant.suits(context);
    if (suits && fits(device_, to_vector(variant.local_size))) {
      return variant;
    }
  }
  throw DeviceError(device_.info().name, "kernel " + std::string(kernel.name),
                    "no variant that fits: its smallest group of " +
                        to_text(to_vector(found->second.back().local_size)) + " invocations exceeds the limits " +
                        to_text(to_vector(device_.properties().limits.maxComputeWorkGroupSize)) + " or " +
                        std::to_string(device_.info().max_group_invocations) + " in all");
}

const VariantPipeline& Pipelines::find_pipeline(const KernelInfo& kernel, const ShaderVariant& variant) {
  auto found = pipelines_.find(&variant);
  if (found == pipelines_.end()) {
    found = pipelines_.emplace(&variant, make(kernel, variant)).first;
    ++made_;
  }
  return found->second;
}

vk::raii::ShaderModule Pipelines::make_module(const ShaderVariant& variant) {
  std::vector<std::uint32_t> spirv(variant.shader.spirv.begin(), variant.shader.spirv.end());
  if (edit_shader_) {
    edit_shader_(variant.shader.name, spirv);
  }
  vk::ShaderModuleCreateInfo info;
  info.setCode(spirv);
  return {device_.handle(), info};
}

VariantPipeline Pipelines::make(const KernelInfo& kernel, const ShaderVariant& variant) {
  VariantPipeline made;
  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  for (std::size_t i = 0; i < kernel.bindings.size(); ++i) {
    bindings.emplace_back(static_cast<std::uint32_t>(i), vk::DescriptorType::eStorageBuffer, 1,
                          vk::ShaderStageFlagBits::eCompute);
  }
  made.set_layout = vk::raii::DescriptorSetLayout(device_.handle(), vk::DescriptorSetLayoutCreateInfo({}, bindings));

  const vk::PushConstantRange params(vk::ShaderStageFlagBits::eCompute, 0,
                                     push_constant_bytes(variant, kernel.params_bytes));
  vk::PipelineLayoutCreateInfo layout({}, *made.set_layout);
  if (params.size > 0) {
    layout.setPushConstantRanges(params);
  }
  made.layout = vk::raii::PipelineLayout(device_.handle(), layout);

  const vk::raii::ShaderModule module = make_module(variant);
  const Specialization specialization(variant);
  const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main",
                                                &specialization.info);
  made.pipeline =
      vk::raii::Pipeline(device_.handle(), cache_.handle(), vk::ComputePipelineCreateInfo({}, stage, *made.layout));
  return made;
}

}  // namespace gdtslam
