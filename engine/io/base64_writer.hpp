// Bytes as base64 (core/base64.hpp) into a file, piece by piece. One writer belongs to one thread.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "atomic_file.hpp"
#include "engine/core/base64.hpp"

namespace gdtslam {

class Base64Writer {
 public:
  /// `file` must outlive this.
  explicit Base64Writer(AtomicFile& file) : file_(file) {}

  void add(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    if (bytes_.size() >= kPiece) write(bytes_.size() / 3 * 3);
  }
  /// The value's bytes as they lie in memory.
  template <class T>
  void add_value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(std::as_bytes(std::span(&value, 1)));
  }
  /// What is left, padded; the next bytes begin a text of their own.
  void finish() { write(bytes_.size()); }

 private:
  static constexpr std::size_t kPiece = 49152;  ///< 64 KiB of text

  void write(std::size_t count) {
    text_.clear();
    append_base64(std::span(bytes_).first(count), text_);
    file_.write(text_);
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(count));
  }

  AtomicFile& file_;
  std::vector<std::byte> bytes_;  ///< not written yet
  std::string text_;
};

}  // namespace gdtslam
