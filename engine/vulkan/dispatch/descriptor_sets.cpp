#include "descriptor_sets.hpp"

#include <algorithm>

namespace gdtslam {
namespace {

constexpr std::uint32_t kSetsPerPool = 128;

}  // namespace

void DescriptorSets::add_pool() {
  const vk::DescriptorPoolSize size(vk::DescriptorType::eStorageBuffer, kSetsPerPool * kMostBindings);
  pools_.emplace_back(device_.handle(), vk::DescriptorPoolCreateInfo({}, kSetsPerPool, size));
  sets_left_ = kSetsPerPool;
}

vk::DescriptorSet DescriptorSets::new_set(const ShaderVariant& variant, const VariantPipeline& pipeline) {
  const auto unused = unused_.find(Key{&variant, {}});
  if (unused != unused_.end()) {
    const vk::DescriptorSet set = unused->second.set;
    unused_.erase(unused);
    return set;
  }
  if (sets_left_ == 0) {
    add_pool();
  }
  const vk::DescriptorSetAllocateInfo info(*pools_.back(), *pipeline.set_layout);
  vk::DescriptorSet set;
  // Without vk::raii, whose sets free themselves one by one; these are freed with their pool.
  const vk::raii::Device& device = device_.handle();
  check(device.getDispatcher()->vkAllocateDescriptorSets(
            *device, &static_cast<const VkDescriptorSetAllocateInfo&>(info), reinterpret_cast<VkDescriptorSet*>(&set)),
        "vkAllocateDescriptorSets");
  --sets_left_;
  return set;
}

void DescriptorSets::write(vk::DescriptorSet set, std::span<DeviceBuffer* const> buffers) const {
  std::array<vk::DescriptorBufferInfo, kMostBindings> infos;
  std::array<vk::WriteDescriptorSet, kMostBindings> writes;
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    infos[i] = vk::DescriptorBufferInfo(*buffers[i]->handle, 0, buffers[i]->padded_bytes);
    writes[i] = vk::WriteDescriptorSet(set, static_cast<std::uint32_t>(i), 0, 1, vk::DescriptorType::eStorageBuffer);
    writes[i].pBufferInfo = &infos[i];
  }
  device_.handle().updateDescriptorSets(vk::ArrayProxy(static_cast<std::uint32_t>(buffers.size()), writes.data()), {});
}

vk::DescriptorSet DescriptorSets::set_for(const ShaderVariant& variant, const VariantPipeline& pipeline,
                                          std::span<const std::uint64_t> ids, std::span<DeviceBuffer* const> buffers,
                                          std::uint64_t batch) {
  Key key{&variant, {}};
  std::copy(ids.begin(), ids.end(), key.ids.begin());
  auto found = sets_.find(key);
  if (found == sets_.end()) {
    const vk::DescriptorSet set = new_set(variant, pipeline);
    write(set, buffers);
    found = sets_.emplace(key, Entry{set, batch}).first;
  }
  found->second.last_batch = batch;
  return found->second.set;
}

void DescriptorSets::drop(std::uint64_t buffer_id) noexcept {
  for (auto entry = sets_.begin(); entry != sets_.end();) {
    const auto next = std::next(entry);
    const auto& ids = entry->first.ids;
    if (std::find(ids.begin(), ids.end(), buffer_id) != ids.end()) {
      dropped_.insert(sets_.extract(entry));
    }
    entry = next;
  }
}

void DescriptorSets::collect(std::uint64_t done_batch) noexcept {
  for (auto entry = dropped_.begin(); entry != dropped_.end();) {
    const auto next = std::next(entry);
    if (entry->second.last_batch <= done_batch) {
      auto node = dropped_.extract(entry);
      node.key().ids = {};
      unused_.insert(std::move(node));
    }
    entry = next;
  }
}

}  // namespace gdtslam
