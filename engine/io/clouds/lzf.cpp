#include "lzf.hpp"

#include <cstdint>

namespace gdtslam {

// A control byte below 32: that many literals plus one. Else three bits of length (7: one more byte follows) and a
// distance of 13 bits back, length plus two bytes to repeat.
std::optional<std::string> unpack_lzf(std::string_view packed, std::size_t size) {
  constexpr std::size_t kLiterals = 32;
  std::string data;
  data.reserve(size);
  std::size_t at = 0;
  const auto byte = [&] { return static_cast<std::size_t>(static_cast<unsigned char>(packed[at++])); };
  while (at < packed.size()) {
    const std::size_t control = byte();
    if (control < kLiterals) {
      const std::size_t count = control + 1;
      if (packed.size() - at < count || size - data.size() < count) return std::nullopt;
      data.append(packed.substr(at, count));
      at += count;
      continue;
    }
    std::size_t count = control >> 5U;
    if (count == 7) {
      if (at == packed.size()) return std::nullopt;
      count += byte();
    }
    if (at == packed.size()) return std::nullopt;
    const std::size_t distance = ((control & 31U) << 8U | byte()) + 1;
    count += 2;
    if (distance > data.size() || size - data.size() < count) return std::nullopt;
    for (std::size_t k = 0; k < count; ++k) data.push_back(data[data.size() - distance]);
  }
  if (data.size() != size) return std::nullopt;
  return data;
}

}  // namespace gdtslam
