#include "gdtslam/io/sha256.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace gdtslam {
namespace {

constexpr std::array<std::uint32_t, 64> kRoundConstants = {
    0x428a2f98U, 0x71374491U, 0xb5c0fbcfU, 0xe9b5dba5U, 0x3956c25bU, 0x59f111f1U, 0x923f82a4U, 0xab1c5ed5U,
    0xd807aa98U, 0x12835b01U, 0x243185beU, 0x550c7dc3U, 0x72be5d74U, 0x80deb1feU, 0x9bdc06a7U, 0xc19bf174U,
    0xe49b69c1U, 0xefbe4786U, 0x0fc19dc6U, 0x240ca1ccU, 0x2de92c6fU, 0x4a7484aaU, 0x5cb0a9dcU, 0x76f988daU,
    0x983e5152U, 0xa831c66dU, 0xb00327c8U, 0xbf597fc7U, 0xc6e00bf3U, 0xd5a79147U, 0x06ca6351U, 0x14292967U,
    0x27b70a85U, 0x2e1b2138U, 0x4d2c6dfcU, 0x53380d13U, 0x650a7354U, 0x766a0abbU, 0x81c2c92eU, 0x92722c85U,
    0xa2bfe8a1U, 0xa81a664bU, 0xc24b8b70U, 0xc76c51a3U, 0xd192e819U, 0xd6990624U, 0xf40e3585U, 0x106aa070U,
    0x19a4c116U, 0x1e376c08U, 0x2748774cU, 0x34b0bcb5U, 0x391c0cb3U, 0x4ed8aa4aU, 0x5b9cca4fU, 0x682e6ff3U,
    0x748f82eeU, 0x78a5636fU, 0x84c87814U, 0x8cc70208U, 0x90befffaU, 0xa4506cebU, 0xbef9a3f7U, 0xc67178f2U};

template <class Integer>
std::array<std::byte, sizeof(Integer)> little_endian(Integer value) {
  std::array<std::byte, sizeof(Integer)> bytes{};
  for (std::byte& byte : bytes) {
    byte = static_cast<std::byte>(value & 0xffU);
    value = static_cast<Integer>(value >> 8U);
  }
  return bytes;
}

std::uint32_t big_endian_word(const std::uint8_t* p) {
  return (std::uint32_t{p[0]} << 24U) | (std::uint32_t{p[1]} << 16U) | (std::uint32_t{p[2]} << 8U) | p[3];
}

}  // namespace

void Sha256::process_block(const std::uint8_t* block) {
  std::array<std::uint32_t, 64> w{};
  for (std::size_t t = 0; t < 16; ++t) {
    w[t] = big_endian_word(block + 4 * t);
  }
  for (std::size_t t = 16; t < 64; ++t) {
    const std::uint32_t s0 = std::rotr(w[t - 15], 7) ^ std::rotr(w[t - 15], 18) ^ (w[t - 15] >> 3U);
    const std::uint32_t s1 = std::rotr(w[t - 2], 17) ^ std::rotr(w[t - 2], 19) ^ (w[t - 2] >> 10U);
    w[t] = w[t - 16] + s0 + w[t - 7] + s1;
  }
  auto [a, b, c, d, e, f, g, h] = state_;
  for (std::size_t t = 0; t < 64; ++t) {
    const std::uint32_t sum1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
    const std::uint32_t choice = (e & f) ^ (~e & g);
    const std::uint32_t t1 = h + sum1 + choice + kRoundConstants[t] + w[t];
    const std::uint32_t sum0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
    const std::uint32_t majority = (a & b) ^ (a & c) ^ (b & c);
    h = g;
    g = f;
    f = e;
    e = d + t1;
    d = c;
    c = b;
    b = a;
    a = t1 + sum0 + majority;
  }
  const std::array<std::uint32_t, 8> sums = {a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < sums.size(); ++i) {
    state_[i] += sums[i];
  }
}

Sha256& Sha256::update(std::span<const std::byte> data) {
  total_bytes_ += data.size();
  while (!data.empty()) {
    const std::size_t count = std::min(data.size(), block_.size() - block_size_);
    std::memcpy(block_.data() + block_size_, data.data(), count);
    block_size_ += count;
    data = data.subspan(count);
    if (block_size_ == block_.size()) {
      process_block(block_.data());
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
    process_block(block_.data());
    block_size_ = 0;
  }
  std::fill(block_.begin() + static_cast<std::ptrdiff_t>(block_size_), block_.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < 8; ++i) {
    block_[kLengthOffset + i] = static_cast<std::uint8_t>(total_bits >> (8U * (7U - i)));
  }
  process_block(block_.data());
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
