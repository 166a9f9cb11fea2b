// Small helpers of the kernels. Own minimum and maximum: those of the library are templates (isa/functions.hpp).

constexpr std::uint8_t lesser(std::uint8_t a, std::uint8_t b) { return a < b ? a : b; }
constexpr std::uint16_t lesser(std::uint16_t a, std::uint16_t b) { return a < b ? a : b; }
constexpr std::uint32_t lesser(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }
constexpr std::uint32_t greater(std::uint32_t a, std::uint32_t b) { return a > b ? a : b; }
constexpr std::uint16_t greater(std::uint16_t a, std::uint16_t b) { return a > b ? a : b; }
constexpr std::int32_t clamped(std::int32_t value, std::int32_t low, std::int32_t high) {
  const std::int32_t raised = value < low ? low : value;
  return raised > high ? high : raised;
}
constexpr std::uint8_t u8(std::uint32_t value) { return static_cast<std::uint8_t>(value); }
constexpr std::uint16_t u16(std::uint32_t value) { return static_cast<std::uint16_t>(value); }
constexpr std::uint32_t u32(std::uint16_t value) { return value; }
constexpr std::size_t at(std::uint32_t stride, std::uint32_t y) { return static_cast<std::size_t>(stride) * y; }
