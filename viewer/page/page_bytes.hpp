// Bytes that a page holds. Thread-safe; O(bytes).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gdtslam::page {

/// Little-endian values one after the other, whatever the host.
class ByteWriter {
 public:
  explicit ByteWriter(std::size_t expected = 0) { bytes_.reserve(expected); }
  void u8(std::uint8_t value) { bytes_.push_back(value); }
  void u16(std::uint16_t value) {
    bytes_.push_back(static_cast<std::uint8_t>(value & 0xFFU));
    bytes_.push_back(static_cast<std::uint8_t>(value >> 8U));
  }
  void f32(double value) {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
    u16(static_cast<std::uint16_t>(bits & 0xFFFFU));
    u16(static_cast<std::uint16_t>(bits >> 16U));
  }
  void clear() { bytes_.clear(); }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// A script element that no browser runs, with the bytes as base64.
void append_bytes_element(const std::string& id, std::span<const std::uint8_t> bytes, std::string& out);

}  // namespace gdtslam::page
