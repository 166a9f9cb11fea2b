// HTML pages of one program: the map of a run (gdtslam/viewer/page.hpp), a drive while it lasts (live) and an atlas
// (fleet). A page is one file: style, program, a description in JSON, and elements with bytes as base64. Names come
// from logs and files of others, so none is trusted. Thread-safe; O(bytes).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gdtslam::page {

using Json = nlohmann::ordered_json;

/// Content of a page: "title" and "subtitle" in the description; the program (page/program) reads the rest of it.
struct PageData {
  Json description = Json::object();
  std::vector<std::pair<std::string, std::string>> elements{};  ///< identifier and bytes as base64
};

void add_element(PageData& data, std::string id, std::span<const std::uint8_t> bytes);

/// The text in one line, without < > and &, so that it is safe within a script element.
std::string json_text(const Json& json);

/// The whole page. It runs its own program only, told by its hash, and takes only what `sources` allows, a part of a
/// content security policy: "img-src 'self'".
std::string page_text(const PageData& data, std::string_view sources);

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
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace gdtslam::page
