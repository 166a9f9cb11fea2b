#include "buffers.hpp"

#include <algorithm>

#include "engine/vulkan/device/device.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

/// Shaders read whole words, up to four at a time.
constexpr std::size_t kGranularity = 16;

constexpr vk::BufferUsageFlags kUsage = vk::BufferUsageFlagBits::eStorageBuffer |
                                        vk::BufferUsageFlagBits::eTransferSrc | vk::BufferUsageFlagBits::eTransferDst;

}  // namespace

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
