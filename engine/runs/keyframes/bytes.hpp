// Writes numbers as bytes, little-endian on every host, and reads them back with a check of the remaining bytes. One
// object belongs to one thread; constant time for each number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace gdtslam {

class BytesOut {
 public:
  BytesOut& byte(std::uint8_t value);
  BytesOut& whole(std::uint32_t value);
  BytesOut& number(double value);
  /// Seven bits in each byte, the lowest first; the eighth bit is set if more follow.
  BytesOut& varint(std::uint64_t value);
  BytesOut& text(std::string_view value);
  /// Returns all bytes so far and empties the object.
  [[nodiscard]] std::string take();

 private:
  std::string bytes_;
};

class BytesIn {
 public:
  /// Both must outlive this; `name` is for messages.
  BytesIn(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  /// These throw InputError if the bytes end before.
  std::uint8_t byte();
  std::uint32_t whole();
  /// Also throws InputError with `what` if the number is not finite.
  double number(const char* what);
  /// At most nine bytes.
  std::uint64_t varint();
  std::string text(std::size_t size);
  /// A count of items with at least `least_bytes` each; InputError if fewer bytes are left.
  std::uint32_t count(const char* what, std::size_t least_bytes);

  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  /// Throws InputError with the file and the current byte.
  [[noreturn]] void refuse(const std::string& fault) const;

 private:
  std::string_view next(std::size_t size);

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
};

}  // namespace gdtslam
