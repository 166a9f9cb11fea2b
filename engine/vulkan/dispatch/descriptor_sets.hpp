// Descriptor sets that bind buffers to a variant's pipeline.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "engine/vulkan/memory/buffers.hpp"
#include "pipelines.hpp"

namespace gdtslam {

/// Most buffers of a kernel: the limit that every Vulkan device guarantees for a stage.
inline constexpr std::size_t kMostBindings = 4;

/// Descriptor sets, each written once and reused for the same variant and buffers.
class DescriptorSets {
 public:
  explicit DescriptorSets(const Device& device) : device_(device) {}

  /// The set of a variant and its buffers, which are given by id and handle.
  vk::DescriptorSet set_for(const ShaderVariant& variant, const VariantPipeline& pipeline,
                            std::span<const std::uint64_t> ids, std::span<DeviceBuffer* const> buffers,
                            std::uint64_t batch);
  /// Drops the sets that bind a buffer; they are reused when the device is done with them.
  void drop(std::uint64_t buffer_id) noexcept;
  void collect(std::uint64_t done_batch) noexcept;

 private:
  struct Key {
    const ShaderVariant* variant = nullptr;
    std::array<std::uint64_t, kMostBindings> ids{};
    friend bool operator<(const Key& a, const Key& b) {
      return std::tie(a.variant, a.ids) < std::tie(b.variant, b.ids);
    }
  };
  struct Entry {
    vk::DescriptorSet set;
    std::uint64_t last_batch = 0;
  };
  vk::DescriptorSet new_set(const ShaderVariant& variant, const VariantPipeline& pipeline);
  void add_pool();
  void write(vk::DescriptorSet set, std::span<DeviceBuffer* const> buffers) const;

  const Device& device_;
  std::vector<vk::raii::DescriptorPool> pools_;
  std::uint32_t sets_left_ = 0;
  std::map<Key, Entry> sets_;
  std::multimap<Key, Entry> dropped_;  ///< possibly still in use
  std::multimap<Key, Entry> unused_;   ///< under a key without buffers, to be rewritten
};

}  // namespace gdtslam
