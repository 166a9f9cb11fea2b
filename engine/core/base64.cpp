#include "base64.hpp"

#include <cstdint>
#include <string_view>

namespace gdtslam {

void append_base64(std::span<const std::byte> bytes, std::string& out) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::size_t begin = out.size();
  out.resize(begin + (bytes.size() + 2) / 3 * 4, '=');
  char* to = out.data() + begin;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t left = bytes.size() - k;
    const std::uint32_t second = left > 1 ? std::to_integer<std::uint32_t>(bytes[k + 1]) : 0U;
    const std::uint32_t third = left > 2 ? std::to_integer<std::uint32_t>(bytes[k + 2]) : 0U;
    const std::uint32_t word = std::to_integer<std::uint32_t>(bytes[k]) << 16U | second << 8U | third;
    *to++ = kLetters[word >> 18U];
    *to++ = kLetters[word >> 12U & 0x3FU];
    if (left > 1) *to = kLetters[word >> 6U & 0x3FU];
    ++to;
    if (left > 2) *to = kLetters[word & 0x3FU];
    ++to;
  }
}

}  // namespace gdtslam
