// Numbers as little-endian bytes on every host, and back. Thread-safe; constant time.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>

namespace gdtslam {

/// The whole number at the start of the bytes, which must be enough.
template <class Whole>
Whole little_endian(const char* bytes) {
  std::make_unsigned_t<Whole> value = 0;
  for (std::size_t k = sizeof(Whole); k-- > 0;) {
    value = static_cast<std::make_unsigned_t<Whole>>(std::uint64_t{value} << 8U | static_cast<unsigned char>(bytes[k]));
  }
  return static_cast<Whole>(value);
}

/// Appends a whole number, or a double by its bits.
template <class Number>
void append_little_endian(std::string& bytes, Number number) {
  if constexpr (std::is_same_v<Number, double>) {
    append_little_endian(bytes, std::bit_cast<std::uint64_t>(number));
  } else if constexpr (std::is_same_v<Number, float>) {
    append_little_endian(bytes, std::bit_cast<std::uint32_t>(number));
  } else {
    std::array<char, sizeof(Number)> piece{};
    for (std::size_t k = 0; k < piece.size(); ++k) {
      piece[k] = static_cast<char>(static_cast<std::uint64_t>(number) >> (8U * k) & 0xffU);
    }
    bytes.append(piece.data(), piece.size());
  }
}

}  // namespace gdtslam
