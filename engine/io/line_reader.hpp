// Lines of a byte source, with a bound on their length, and bytes between them. One reader belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/io/byte_source.hpp"

namespace gdtslam {

/// One line without its end ("\n" or "\r\n"), valid until the next call.
struct TextLine {
  std::string_view text;
  std::uint64_t number = 0;  ///< from 1
  bool has_newline = true;   ///< false only for a last line that may have been cut off
  bool is_too_long = false;  ///< the text holds the beginning only
};

class LineReader {
 public:
  LineReader(std::unique_ptr<ByteSource> source, std::size_t max_line_bytes);
  /// The next line, or nothing at the end. After a line that is too long, the next call skips its rest.
  std::optional<TextLine> next();
  /// Skips empty lines at the current position, at the speed of memory, and returns the number of the last line so far.
  /// Waits for bytes of a live source as next() does.
  std::uint64_t skip_empty_lines();
  /// The bytes from the current position, without consuming them: at least a line or `bytes` bytes, less only at the
  /// end. Reads no more than that from a live source.
  std::string_view peek(std::size_t bytes);
  /// The next `count` raw bytes, valid until the next call; nullptr if the input ends before.
  const char* bytes(std::size_t count) {
    const char* const data = peek_bytes(count);
    if (data != nullptr) begin_ += count;
    return data;
  }
  /// The same without consuming them.
  const char* peek_bytes(std::size_t count) {
    while (end_ - begin_ < count) {
      if (!fill()) return nullptr;
    }
    return buffer_.data() + begin_;
  }
  /// Up to `most` available bytes; empty at the end.
  std::string_view some(std::size_t most);
  [[nodiscard]] const ByteSource& source() const { return *source_; }

 private:
  bool fill();
  void skip_rest_of_line();
  TextLine take(std::size_t length, std::size_t consumed, bool has_newline);

  std::unique_ptr<ByteSource> source_;
  std::size_t max_line_bytes_;
  std::vector<char> buffer_;
  bool is_filled_ = false;  ///< the last read filled the buffer: there may be more
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t line_number_ = 0;
  bool source_ended_ = false;
  bool inside_long_line_ = false;
};

}  // namespace gdtslam
