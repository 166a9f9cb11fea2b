// Numbers as bytes, little-endian whatever the host, and back; what is read is checked against the bytes that are
// there. One object belongs to one thread; constant time each.
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
  /// Seven bits a byte, the lowest first, the eighth where more follow.
  BytesOut& varint(std::uint64_t value);
  BytesOut& text(std::string_view value);
  /// All bytes so far; the object is empty then.
  [[nodiscard]] std::string take();

 private:
  std::string bytes_;
};

class BytesIn {
 public:
  /// Both must outlive this; `name` stands in messages.
  BytesIn(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  /// These throw InputError where the bytes end before.
  std::uint8_t byte();
  std::uint32_t whole();
  /// Throws InputError too where it is not finite, naming what it is.
  double number(const char* what);
  /// At most nine bytes.
  std::uint64_t varint();
  std::string text(std::size_t size);
  /// How many of something follow that takes at least so many bytes each; InputError where fewer bytes are left.
  std::uint32_t count(const char* what, std::size_t least_bytes);

  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  /// InputError with the file and the byte that was reached.
  [[noreturn]] void refuse(const std::string& fault) const;

 private:
  std::string_view next(std::size_t size);

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
};

}  // namespace gdtslam
