#include "gdtslam/io/sha256.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "sha256_blocks.hpp"

namespace gdtslam {
namespace {

template <class Integer>
std::array<std::byte, sizeof(Integer)> little_endian(Integer value) {
  std::array<std::byte, sizeof(Integer)> bytes{};
  for (std::byte& byte : bytes) {
    byte = static_cast<std::byte>(value & 0xffU);
    value = static_cast<Integer>(value >> 8U);
  }
  return bytes;
}

}  // namespace

void Sha256::process_blocks(const std::uint8_t* blocks, std::size_t count) {
  static const bool has_instructions = has_sha_instructions();
  if (has_instructions) return process_with_instructions(state_, blocks, count);
  process_portably(state_, blocks, count);
}

Sha256& Sha256::update(std::span<const std::byte> data) {
  total_bytes_ += data.size();
  while (!data.empty()) {
    if (block_size_ == 0 && data.size() >= block_.size()) {
      const std::size_t blocks = data.size() / block_.size();
      process_blocks(reinterpret_cast<const std::uint8_t*>(data.data()), blocks);
      data = data.subspan(blocks * block_.size());
      continue;
    }
    const std::size_t count = std::min(data.size(), block_.size() - block_size_);
    std::memcpy(block_.data() + block_size_, data.data(), count);
    block_size_ += count;
    data = data.subspan(count);
    if (block_size_ == block_.size()) {
      process_blocks(block_.data(), 1);
      block_size_ = 0;
    }
  }
  return *this;
}

Sha256& Sha256::update(std::string_view text) { return update(std::as_bytes(std::span(text.data(), text.size()))); }
Sha256& Sha256::update(double value) { return update(little_endian(std::bit_cast<std::uint64_t>(value))); }
Sha256& Sha256::update(std::int32_t value) { return update(little_endian(std::bit_cast<std::uint32_t>(value))); }
Sha256& Sha256::update(std::uint16_t value) { return update(little_endian(value)); }

std::string Sha256::hex() {
  const std::uint64_t total_bits = total_bytes_ * 8U;
  constexpr std::size_t kLengthOffset = 56;
  block_[block_size_++] = 0x80U;
  if (block_size_ > kLengthOffset) {
    std::fill(block_.begin() + static_cast<std::ptrdiff_t>(block_size_), block_.end(), std::uint8_t{0});
    process_blocks(block_.data(), 1);
    block_size_ = 0;
  }
  std::fill(block_.begin() + static_cast<std::ptrdiff_t>(block_size_), block_.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < 8; ++i) {
    block_[kLengthOffset + i] = static_cast<std::uint8_t>(total_bits >> (8U * (7U - i)));
  }
  process_blocks(block_.data(), 1);
  std::string text;
  for (const std::uint32_t word : state_) {
    text += fmt::format("{:08x}", word);
  }
  return text;
}

std::string sha256_of(const DistanceFieldView& field) {
  Sha256 hash;
  const GridGeometry& geometry = field.geometry;
  hash.update(geometry.resolution_m).update(geometry.origin_x_m).update(geometry.origin_y_m);
  hash.update(geometry.width).update(geometry.height);
  std::vector<std::byte> row(2 * static_cast<std::size_t>(geometry.width));
  for (std::int32_t y = 0; y < geometry.height; ++y) {
    for (std::int32_t x = 0; x < geometry.width; ++x) {
      const auto bytes = little_endian(field.at({x, y}));
      std::copy(bytes.begin(), bytes.end(), row.begin() + 2 * std::ptrdiff_t{x});
    }
    hash.update(row);
  }
  return hash.hex();
}

std::string sha256_of(const Trajectory& trajectory) {
  Sha256 hash;
  for (const StampedPose& pose : trajectory) {
    hash.update(pose.T_map_base.x_m).update(pose.T_map_base.y_m).update(pose.T_map_base.theta_rad);
  }
  return hash.hex();
}

}  // namespace gdtslam
