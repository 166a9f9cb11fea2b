#include "buffers.hpp"

#include <algorithm>
#include <optional>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{32} << 20U;
/// Divisor of the heap's size for the largest block, so that the first buffer does not fill a small device.
constexpr std::size_t kBlocksOfHeap = 16;

std::optional<std::uint32_t> find_type(const vk::PhysicalDeviceMemoryProperties& memory, std::uint32_t bits,
                                       vk::MemoryPropertyFlags flags) {
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    if ((bits >> i & 1U) != 0 && (memory.memoryTypes[i].propertyFlags & flags) == flags) {
      return i;
    }
  }
  return std::nullopt;
}

std::size_t rounded_up(std::size_t value, std::size_t multiple) { return (value + multiple - 1) / multiple * multiple; }

/// Shaders read whole words, up to four at a time.
constexpr std::size_t kGranularity = 16;

constexpr vk::BufferUsageFlags kUsage = vk::BufferUsageFlagBits::eStorageBuffer |
                                        vk::BufferUsageFlagBits::eTransferSrc | vk::BufferUsageFlagBits::eTransferDst;

}  // namespace

std::uint32_t memory_type(const Device& device, std::uint32_t bits, vk::MemoryPropertyFlags wanted,
                          vk::MemoryPropertyFlags needed) {
  for (const vk::MemoryPropertyFlags flags : {wanted, needed}) {
    if (const auto type = find_type(device.memory(), bits, flags)) {
      return *type;
    }
  }
  throw DeviceError(device.info().name, "vkGetPhysicalDeviceMemoryProperties",
                    "no memory of the type " + vk::to_string(needed));
}

BlockMemory::BlockMemory(const Device& device)
    : device_(device), block_bytes_(std::min(kBlockBytes, device.info().memory_bytes / kBlocksOfHeap)) {}

BlockMemory::Block& BlockMemory::add_block(std::uint32_t type, std::size_t bytes) {
  try {
    vk::raii::DeviceMemory memory(device_.handle(), vk::MemoryAllocateInfo(bytes, type));
    blocks_.push_back({next_id_++, type, bytes, std::move(memory), {{0, bytes}}});
  } catch (const vk::SystemError& error) {
    const auto result = static_cast<vk::Result>(error.code().value());
    if (result != vk::Result::eErrorOutOfDeviceMemory && result != vk::Result::eErrorOutOfHostMemory) {
      throw;
    }
    throw DeviceError(device_.info().name, "vkAllocateMemory",
                      vk::to_string(result) + " for " + std::to_string(bytes) + " bytes; the device has " +
                          std::to_string(device_.info().memory_bytes));
  }
  bytes_ += bytes;
  return blocks_.back();
}

bool BlockMemory::take_from(Block& block, const vk::MemoryRequirements& requirements, MemoryRange& range) {
  for (auto hole = block.free.begin(); hole != block.free.end(); ++hole) {
    const auto [begin, bytes] = *hole;
    const std::size_t offset = rounded_up(begin, requirements.alignment);
    const std::size_t lead = offset - begin;
    if (bytes < lead || bytes - lead < requirements.size) {
      continue;
    }
    const std::size_t rest = bytes - lead - requirements.size;
    block.free.erase(hole);
    if (lead > 0) {
      block.free.emplace(begin, lead);
    }
    if (rest > 0) {
      block.free.emplace(offset + requirements.size, rest);
    }
    range = {*block.memory, block.id, offset, requirements.size};
    return true;
  }
  return false;
}

MemoryRange BlockMemory::take(const vk::MemoryRequirements& requirements) {
  const std::uint32_t type = memory_type(device_, requirements.memoryTypeBits, vk::MemoryPropertyFlagBits::eDeviceLocal,
                                         vk::MemoryPropertyFlags());
  MemoryRange range;
  const bool own_block = requirements.size > block_bytes_ / 2;
  if (!own_block) {
    for (Block& block : blocks_) {
      if (block.type == type && block.bytes == block_bytes_ && take_from(block, requirements, range)) {
        return range;
      }
    }
  }
  Block& block = add_block(type, own_block ? requirements.size : block_bytes_);
  take_from(block, requirements, range);
  return range;
}

void BlockMemory::give_back(const MemoryRange& range) noexcept {
  const auto block =
      std::find_if(blocks_.begin(), blocks_.end(), [&](const Block& other) { return other.id == range.block; });
  auto [hole, is_new] = block->free.emplace(range.offset, range.bytes);
  const auto after = std::next(hole);
  if (after != block->free.end() && hole->first + hole->second == after->first) {
    hole->second += after->second;
    block->free.erase(after);
  }
  if (hole != block->free.begin()) {
    const auto before = std::prev(hole);
    if (before->first + before->second == hole->first) {
      before->second += hole->second;
      block->free.erase(hole);
      hole = before;
    }
  }
  // A block that holds one large buffer is freed with it. An empty shared block is freed, except the first.
  const bool is_empty = hole->second == block->bytes;
  if (is_empty && (block->bytes != block_bytes_ || block->id != blocks_.front().id)) {
    bytes_ -= block->bytes;
    blocks_.erase(block);
  }
}

std::size_t padded_size(std::size_t bytes) {
  return std::max(kGranularity, (bytes + kGranularity - 1) / kGranularity * kGranularity);
}

Buffers::~Buffers() {
  for (auto* buffers : {&live_, &released_}) {
    buffers->clear();
  }
}

void Buffers::check_size(std::size_t bytes) const {
  const std::size_t allowed = device_.max_buffer_bytes();
  if (bytes > allowed) {
    throw DeviceError(device_.info().name, "allocate",
                      "no buffer: " + std::to_string(bytes) + " bytes were asked for, the largest allowed is " +
                          std::to_string(allowed));
  }
}

bool Buffers::would_be_tight(std::size_t bytes) const {
  return memory_.bytes() + bytes > device_.info().memory_bytes / 4 * 3;
}

std::uint64_t Buffers::create(std::size_t bytes) {
  DeviceBuffer buffer;
  buffer.bytes = bytes;
  buffer.padded_bytes = padded_size(bytes);
  buffer.handle = vk::raii::Buffer(device_.handle(), vk::BufferCreateInfo({}, buffer.padded_bytes, kUsage));
  buffer.range = memory_.take(buffer.handle.getMemoryRequirements());
  try {
    buffer.handle.bindMemory(buffer.range.memory, buffer.range.offset);
  } catch (...) {
    memory_.give_back(buffer.range);
    throw;
  }
  const std::uint64_t id = next_id_++;
  live_.emplace(id, std::move(buffer));
  return id;
}

void Buffers::release(std::uint64_t id) noexcept { released_.insert(live_.extract(id)); }

void Buffers::collect(std::uint64_t done_batch) noexcept {
  for (auto entry = released_.begin(); entry != released_.end();) {
    if (entry->second.last_batch > done_batch) {
      ++entry;
      continue;
    }
    entry->second.handle.clear();
    memory_.give_back(entry->second.range);
    entry = released_.erase(entry);
  }
}

}  // namespace gdtslam
