// Collects bytes that come in pieces and returns whole lines, so that an unfinished line of a sender can be dropped
// before it is read. One object belongs to one thread. Cost: a copy of the bytes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace gdtslam {

class WholeLines {
 public:
  void add(std::string_view bytes) {
    const std::size_t newline = bytes.rfind('\n');
    if (newline != std::string_view::npos) whole_ = buffer_.size() + newline + 1;
    buffer_ += bytes;
    if (buffer_.size() - whole_ > kLongestLine) whole_ = buffer_.size();  // the reader of lines refuses it
  }
  [[nodiscard]] bool is_empty() const { return given_ == whole_; }
  /// Fills at most the target.
  std::size_t take(std::span<char> target) {
    const std::size_t count = std::min(target.size(), whole_ - given_);
    std::copy_n(buffer_.data() + given_, count, target.data());
    given_ += count;
    if (given_ == whole_) {
      buffer_.erase(0, given_);
      given_ = whole_ = 0;
    }
    return count;
  }
  /// Drops a line without its end; false if there was none.
  bool drop_rest() {
    const bool is_there = buffer_.size() > whole_;
    buffer_.resize(whole_);
    return is_there;
  }

 private:
  static constexpr std::size_t kLongestLine = std::size_t{8} << 20U;  // longer than readers of lines accept

  std::string buffer_;
  std::size_t given_ = 0;
  std::size_t whole_ = 0;  // bytes up to the end of the last whole line
};

}  // namespace gdtslam
