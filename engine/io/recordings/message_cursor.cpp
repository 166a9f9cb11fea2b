#include "message_cursor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace gdtslam {
namespace {

constexpr std::size_t kEncapsulationBytes = 4;

}  // namespace

MessageCursor::MessageCursor(std::string_view bytes, MessageEncoding encoding) : bytes_(bytes), encoding_(encoding) {
  if (encoding != MessageEncoding::kCdr) return;
  const std::string_view head = take(kEncapsulationBytes);
  const unsigned kind = 256U * static_cast<unsigned char>(head[0]) + static_cast<unsigned char>(head[1]);
  // Plain CDR of both versions, big and little endian; the second version aligns nothing to 8 bytes.
  if (kind != 0 && kind != 1 && kind != 6 && kind != 7) {
    throw RecordingFault(fmt::format("has a CDR message of encoding {}; plain ones (0, 1, 6, 7) are read", kind));
  }
  is_big_ = kind % 2 == 0;
  most_alignment_ = kind < 2 ? 8 : 4;
  bytes_.remove_prefix(kEncapsulationBytes);
  position_ = 0;
}

std::string_view MessageCursor::take(std::size_t count) {
  if (count > bytes_.size() - position_) throw RecordingFault("has a message that ends too early");
  const std::string_view taken = bytes_.substr(position_, count);
  position_ += count;
  return taken;
}

std::string_view MessageCursor::take_aligned(std::size_t size) {
  const std::size_t alignment = std::min(size, most_alignment_);
  (void)take((alignment - position_ % alignment) % alignment);
  return take(size);
}

double MessageCursor::time() {
  const double seconds = encoding_ == MessageEncoding::kCdr ? static_cast<double>(whole<std::int32_t>())
                                                            : static_cast<double>(whole<std::uint32_t>());
  constexpr double kParts = 1.0e9;  // used as a divisor, so that 600,000,000 gives the double nearest to 0.6
  return seconds + static_cast<double>(whole<std::uint32_t>()) / kParts;
}

double MessageCursor::header_time() {
  if (encoding_ == MessageEncoding::kRos1) (void)whole<std::uint32_t>();
  return time();
}

std::string_view MessageCursor::text() {
  std::string_view taken = take(whole<std::uint32_t>());
  if (encoding_ == MessageEncoding::kCdr && taken.ends_with('\0')) taken.remove_suffix(1);
  return taken;
}

std::string MessageCursor::frame() {
  std::string_view name = text();
  if (name.starts_with('/')) name.remove_prefix(1);
  return std::string(name);
}

std::size_t MessageCursor::count(std::size_t least_bytes) {
  const std::size_t stated = whole<std::uint32_t>();
  if (stated > (bytes_.size() - position_) / least_bytes) {
    throw RecordingFault("has a message with fewer values than it states");
  }
  return stated;
}

void MessageCursor::singles(std::vector<float>& values) {
  const std::size_t size = count(sizeof(float));
  values.resize(size);
  if (is_big_ || std::endian::native != std::endian::little) {
    for (float& value : values) value = single();
  } else if (size > 0) {  // they are aligned after their count
    std::memcpy(values.data(), take(size * sizeof(float)).data(), size * sizeof(float));
  }
}

}  // namespace gdtslam
