// Lines and raw bytes of one input (a cloud or a mesh), in turn, with a bound on both. One input belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/byte_source.hpp"

namespace gdtslam {

class CloudInput {
 public:
  CloudInput(std::unique_ptr<ByteSource> source, std::string name);

  static constexpr std::size_t kMostLineBytes = 65536;
  /// The next line without its end; nothing at the end of the input. Throws InputError for one that is too long.
  std::optional<std::string_view> line();
  /// The next `count` bytes (at most kMostBytes), valid until the next call; nullptr where the input ends before.
  const char* bytes(std::size_t count) {
    const char* const data = peek(count);
    if (data != nullptr) begin_ += count;
    return data;
  }
  /// The same without going on.
  const char* peek(std::size_t count) {
    return end_ - begin_ < count && !fill(count) ? nullptr : buffer_.data() + begin_;
  }
  static constexpr std::size_t kMostBytes = 65536;
  /// Up to `most` bytes that there are; empty at the end.
  std::string_view some(std::size_t most);
  [[nodiscard]] std::uint64_t line_number() const { return line_number_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  /// What is wrong with the end of the input, known once it has been met.
  [[nodiscard]] std::string defect() const { return source_->defect(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const { return source_->bytes_from_file(); }

 private:
  bool fill(std::size_t count);
  void check_line(std::size_t bytes) const;

  std::unique_ptr<ByteSource> source_;
  std::string name_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t line_number_ = 0;
};

}  // namespace gdtslam
