// Bytes as base64 [RFC4648], as one text. Thread-safe; O(n).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace gdtslam {

inline std::string base64_text(std::string_view bytes) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t held = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      held = held << 8U | (k + j < bytes.size() ? static_cast<std::uint8_t>(bytes[k + j]) : 0U);
    }
    for (std::size_t j = 0; j < 4; ++j) {
      text += k + j <= bytes.size() ? kLetters[held >> (18U - 6U * static_cast<std::uint32_t>(j)) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace gdtslam
