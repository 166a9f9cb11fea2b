#include "cloud_input.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 18U;

}  // namespace

CloudInput::CloudInput(std::unique_ptr<ByteSource> source, std::string name)
    : source_(std::move(source)), name_(std::move(name)), buffer_(kBufferBytes) {}

// At least `count` bytes from begin_ on; false at the end of the input.
bool CloudInput::fill(std::size_t count) {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  while (end_ < count) {
    const std::size_t read = source_->read(std::span(buffer_).subspan(end_));
    if (read == 0) return false;
    end_ += read;
  }
  return true;
}

void CloudInput::check_line(std::size_t bytes) const {
  if (bytes <= kMostLineBytes) return;
  throw InputError({name_, line_number_ + 1},
                   "the line is longer than 64 KiB: is this the right file, and is it whole?");
}

std::optional<std::string_view> CloudInput::line() {
  std::size_t searched = 0;
  for (;;) {
    const char* const from = buffer_.data() + begin_;
    const auto* const newline = static_cast<const char*>(std::memchr(from + searched, '\n', end_ - begin_ - searched));
    if (newline != nullptr) {
      const auto length = static_cast<std::size_t>(newline - from);
      check_line(length);
      begin_ += length + 1;
      ++line_number_;
      std::string_view text(from, length);
      if (text.ends_with('\r')) text.remove_suffix(1);
      return text;
    }
    searched = end_ - begin_;
    check_line(searched);
    if (fill(searched + 1)) continue;
    if (end_ == begin_) return std::nullopt;
    std::string_view text(buffer_.data() + begin_, end_ - begin_);
    begin_ = end_;
    ++line_number_;
    return text;
  }
}

std::string_view CloudInput::some(std::size_t most) {
  if (begin_ == end_ && !fill(1)) return {};
  const std::size_t count = std::min(most, end_ - begin_);
  const std::string_view data(buffer_.data() + begin_, count);
  begin_ += count;
  return data;
}

}  // namespace gdtslam
