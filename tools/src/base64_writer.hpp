// Bytes as base64 [Josefsson2006] into a file, piece by piece. One writer belongs to one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "gdtslam/io/atomic_file.hpp"

namespace gdtslam {

class Base64Writer {
 public:
  /// `file` must outlive this.
  explicit Base64Writer(AtomicFile& file) : file_(file) {}

  void add(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) {
      held_ = held_ << 8U | std::to_integer<std::uint32_t>(byte);
      if (++count_ == 3) put(4);
    }
    if (text_.size() > kPiece) write();
  }
  /// The value's bytes as they lie in memory.
  template <class T>
  void add_value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(std::as_bytes(std::span(&value, 1)));
  }
  /// What is left, padded; the next bytes begin a text of their own.
  void finish() {
    if (count_ > 0) {
      const std::size_t letters = count_ + 1;
      held_ <<= 8U * (3 - count_);
      put(letters);
      text_.append(4 - letters, '=');
    }
    write();
  }

 private:
  static constexpr std::size_t kPiece = 65536;
  static constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

  void put(std::size_t letters) {
    for (std::size_t k = 0; k < letters; ++k) text_ += kLetters[held_ >> (18U - 6U * k) & 63U];
    held_ = 0;
    count_ = 0;
  }
  void write() {
    file_.write(text_);
    text_.clear();
  }

  AtomicFile& file_;
  std::uint32_t held_ = 0;
  std::size_t count_ = 0;
  std::string text_;
};

}  // namespace gdtslam
