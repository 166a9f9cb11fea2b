// Reads the fields of a message in order: the packed serialisation of ROS 1, and CDR of ROS 2, whose values are aligned
// relative to the end of the four bytes that state the encoding. Thread-safe; linear in the bytes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "containers/recording.hpp"

namespace gdtslam {

class MessageCursor {
 public:
  /// Throws RecordingFault if a CDR message states another encoding.
  MessageCursor(std::string_view bytes, MessageEncoding encoding);

  template <class Whole>
  Whole whole() {
    using Bits = std::make_unsigned_t<Whole>;
    const std::string_view raw = take_aligned(sizeof(Whole));
    Bits value = 0;
    for (std::size_t k = 0; k < sizeof(Whole); ++k) {
      const std::size_t place = is_big_ ? sizeof(Whole) - 1 - k : k;
      value |= static_cast<Bits>(static_cast<Bits>(static_cast<unsigned char>(raw[k])) << (8U * place));
    }
    return static_cast<Whole>(value);
  }
  float single() { return std::bit_cast<float>(whole<std::uint32_t>()); }
  double real() { return std::bit_cast<double>(whole<std::uint64_t>()); }
  /// Seconds.
  double time();
  /// The start of a header: a sequence number in ROS 1, then the time.
  double header_time();
  std::string_view text();
  /// A frame's name without a leading slash.
  std::string frame();
  /// A count of items of at least `least_bytes` each. Throws RecordingFault if fewer bytes are left.
  std::size_t count(std::size_t least_bytes);
  void singles(std::vector<float>& values);
  [[nodiscard]] MessageEncoding encoding() const { return encoding_; }

 private:
  std::string_view take(std::size_t count);
  std::string_view take_aligned(std::size_t size);

  std::string_view bytes_;
  std::size_t position_ = 0;
  MessageEncoding encoding_;
  std::size_t most_alignment_ = 1;
  bool is_big_ = false;
};

}  // namespace gdtslam
