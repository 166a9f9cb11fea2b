#include "transfers.hpp"

#include <algorithm>
#include <cstring>

namespace gdtslam {
namespace {

constexpr std::size_t kUploadSegmentBytes = std::size_t{4} << 20U;
constexpr std::size_t kDownloadSegmentBytes = std::size_t{4} << 20U;
constexpr std::size_t kAlignment = 64;  // a cache line, so that copies are whole lines

using Memory = vk::MemoryPropertyFlagBits;

}  // namespace

StagingRing::StagingRing(const Device& device, std::size_t segment_bytes, vk::BufferUsageFlags usage,
                         vk::MemoryPropertyFlags wanted)
    : segment_bytes_(segment_bytes),
      buffer_(device.handle(), vk::BufferCreateInfo({}, segment_bytes * Batches::kSlots, usage)),
      device_memory_(nullptr) {
  const vk::MemoryRequirements requirements = buffer_.getMemoryRequirements();
  const vk::MemoryPropertyFlags needed = Memory::eHostVisible | Memory::eHostCoherent;
  const std::uint32_t type = memory_type(device, requirements.memoryTypeBits, needed | wanted, needed);
  device_memory_ = vk::raii::DeviceMemory(device.handle(), vk::MemoryAllocateInfo(requirements.size, type));
  buffer_.bindMemory(*device_memory_, 0);
  memory_ = static_cast<std::byte*>(device_memory_.mapMemory(0, VK_WHOLE_SIZE));
}

std::size_t StagingRing::take(std::size_t segment, std::size_t bytes, std::size_t& offset) {
  const std::size_t taken = std::min(bytes, segment_bytes_ - used_[segment]);
  offset = segment * segment_bytes_ + used_[segment];
  used_[segment] = std::min(segment_bytes_, (used_[segment] + taken + kAlignment - 1) / kAlignment * kAlignment);
  return taken;
}

Transfers::Transfers(const Device& device, Batches& batches, BarrierTracker& barriers)
    : batches_(batches),
      barriers_(barriers),
      up_(device, kUploadSegmentBytes, vk::BufferUsageFlagBits::eTransferSrc, {}),
      down_(device, kDownloadSegmentBytes, vk::BufferUsageFlagBits::eTransferDst, Memory::eHostCached) {
  batches_.set_on_reuse([this](std::size_t slot) { reuse(slot); });
}

void Transfers::begin_operation(DeviceBuffer& buffer, bool is_written) {
  barriers_.need(buffer.history, is_written);
  barriers_.begin(batches_.commands());
}

void Transfers::note_operation(DeviceBuffer& buffer, bool is_written) {
  barriers_.note(buffer.history, Stage::kTransfer, !is_written, is_written);
  buffer.last_batch = batches_.value();
}

void Transfers::fill(DeviceBuffer& target, std::uint32_t word) {
  begin_operation(target, true);
  ++counts_.fills;
  batches_.commands().fillBuffer(*target.handle, 0, target.padded_bytes, word);
  note_operation(target, true);
  target.is_fresh = false;
}

void Transfers::copy(DeviceBuffer& source, DeviceBuffer& target) {
  make_ready(source);
  barriers_.need(source.history, false);
  begin_operation(target, true);
  batches_.commands().copyBuffer(*source.handle, *target.handle, vk::BufferCopy(0, 0, source.padded_bytes));
  note_operation(source, false);
  note_operation(target, true);
  target.is_fresh = false;
}

void Transfers::make_ready(DeviceBuffer& buffer) {
  if (buffer.is_fresh) {
    fill(buffer, 0);
  }
}

void Transfers::upload(DeviceBuffer& target, std::span<const std::byte> data, std::size_t offset) {
  // A buffer that is fully overwritten needs no zeroing first, except for the padding of its last word.
  if (data.size() == target.bytes && target.bytes % 4 == 0) {
    target.is_fresh = false;
  }
  make_ready(target);
  while (!data.empty()) {
    batches_.commands();
    std::size_t ring_offset = 0;
    const std::size_t bytes = up_.take(batches_.slot(), data.size(), ring_offset);
    if (bytes == 0) {
      batches_.submit();
      continue;
    }
    std::memcpy(up_.at(ring_offset), data.data(), bytes);
    ++counts_.uploads;
    counts_.upload_bytes += bytes;
    begin_operation(target, true);
    batches_.commands().copyBuffer(up_.buffer(), *target.handle, vk::BufferCopy(ring_offset, offset, bytes));
    note_operation(target, true);
    data = data.subspan(bytes);
    offset += bytes;
  }
}

std::uint64_t Transfers::start_download(DeviceBuffer& source, std::size_t bytes, std::size_t offset) {
  make_ready(source);
  const std::uint64_t id = next_id_++;
  Download& download = downloads_[id];
  download.bytes = bytes;
  for (std::size_t done = 0; done < bytes;) {
    batches_.commands();
    Piece piece;
    piece.bytes = down_.take(batches_.slot(), bytes - done, piece.ring_offset);
    if (piece.bytes == 0) {
      batches_.submit();
      continue;
    }
    begin_operation(source, false);
    batches_.commands().copyBuffer(*source.handle, down_.buffer(),
                                   vk::BufferCopy(offset + done, piece.ring_offset, piece.bytes));
    note_operation(source, false);
    batches_.deliver_to_host();
    ++counts_.downloads;
    counts_.download_bytes += piece.bytes;
    piece.batch = batches_.value();
    piece.slot = batches_.slot();
    piece.target_offset = done;
    download.pieces.push_back(piece);
    done += piece.bytes;
  }
  return id;
}

bool Transfers::is_under_way(std::uint64_t id, std::size_t bytes) const {
  const auto found = downloads_.find(id);
  return found != downloads_.end() && found->second.bytes == bytes;
}

void Transfers::finish_download(std::uint64_t id, std::span<std::byte> data) {
  const Download& download = downloads_.at(id);
  for (const Piece& piece : download.pieces) {
    if (piece.is_kept) {
      std::memcpy(data.data() + piece.target_offset, download.kept.get() + piece.target_offset, piece.bytes);
      continue;
    }
    if (piece.batch > batches_.submitted()) {
      batches_.submit();
    }
    batches_.wait_for(piece.batch);
    std::memcpy(data.data() + piece.target_offset, down_.at(piece.ring_offset), piece.bytes);
  }
  downloads_.erase(id);
}

void Transfers::reuse(std::size_t slot) {
  up_.reset(slot);
  down_.reset(slot);
  for (auto& [id, download] : downloads_) {
    for (Piece& piece : download.pieces) {
      if (piece.slot != slot || piece.is_kept) {
        continue;
      }
      if (!download.kept) {
        download.kept = std::make_unique_for_overwrite<std::byte[]>(download.bytes);
      }
      std::memcpy(download.kept.get() + piece.target_offset, down_.at(piece.ring_offset), piece.bytes);
      piece.is_kept = true;
    }
  }
}

}  // namespace gdtslam
