#include "bytes.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <utility>

#include "engine/io/little_endian.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostVarintBytes = 9;  // 63 bits, which a signed number holds

}  // namespace

BytesOut& BytesOut::byte(std::uint8_t value) {
  bytes_ += static_cast<char>(value);
  return *this;
}

BytesOut& BytesOut::whole(std::uint32_t value) {
  append_little_endian(bytes_, value);
  return *this;
}

BytesOut& BytesOut::number(double value) {
  append_little_endian(bytes_, value);
  return *this;
}

BytesOut& BytesOut::varint(std::uint64_t value) {
  for (; value >= 0x80U; value >>= 7U) bytes_ += static_cast<char>((value & 0x7fU) | 0x80U);
  bytes_ += static_cast<char>(value);
  return *this;
}

BytesOut& BytesOut::text(std::string_view value) {
  bytes_ += value;
  return *this;
}

std::string BytesOut::take() { return std::exchange(bytes_, {}); }

void BytesIn::refuse(const std::string& fault) const {
  throw InputError({name_, 0}, fmt::format("at byte {}, unpacked: {}", at_, fault));
}

std::string_view BytesIn::next(std::size_t size) {
  if (left() < size) refuse("ends within a number or a text");
  const std::string_view piece = bytes_.substr(at_, size);
  at_ += size;
  return piece;
}

std::uint8_t BytesIn::byte() { return static_cast<std::uint8_t>(next(1).front()); }
std::uint32_t BytesIn::whole() { return little_endian<std::uint32_t>(next(sizeof(std::uint32_t)).data()); }

double BytesIn::number(const char* what) {
  const auto value = std::bit_cast<double>(little_endian<std::uint64_t>(next(sizeof(double)).data()));
  if (!std::isfinite(value)) refuse(fmt::format("has {} that is not finite", what));
  return value;
}

std::uint64_t BytesIn::varint() {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < kMostVarintBytes; ++i) {
    const std::uint8_t piece = byte();
    value |= static_cast<std::uint64_t>(piece & 0x7fU) << (7U * i);
    if ((piece & 0x80U) == 0) return value;
  }
  refuse("has a number of more than nine bytes");
}

std::string BytesIn::text(std::size_t size) { return std::string(next(size)); }

std::uint32_t BytesIn::count(const char* what, std::size_t least_bytes) {
  const std::uint32_t value = whole();
  if (value > left() / least_bytes) {
    refuse(fmt::format("has {} {} by its own count, and {} bytes are left", value, what, left()));
  }
  return value;
}

}  // namespace gdtslam
