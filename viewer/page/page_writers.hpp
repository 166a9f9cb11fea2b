// Words, numbers and bytes on their way into a page: its JSON and its elements (into its HTML: drawing/markup.hpp).
// Names come from logs and files of others, so none is trusted. Thread-safe; O(length).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/pose3.hpp"

namespace gdtslam::page {

/// A JSON string with its quotes, of text made valid by clean_utf8; safe within a script element, as it holds no <, >
/// or &.
std::string json_text(std::string_view text);
/// The shortest decimal that reads back as the same double; null where it is not finite.
std::string json_number(double value);

/// Builds one JSON text. Keys are ours and need no escaping.
class JsonWriter {
 public:
  JsonWriter& open(std::string_view key, char bracket);  ///< "" as key within arrays and at the top
  JsonWriter& close();
  JsonWriter& text(std::string_view key, std::string_view value);
  JsonWriter& number(std::string_view key, double value);
  JsonWriter& point(std::string_view key, const Point3& value);  ///< [x, y, z]
  [[nodiscard]] const std::string& str() const { return out_; }

 private:
  void begin(std::string_view key);
  std::string out_;
  std::string closers_;
  bool needs_comma_ = false;
};

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
