#include "line_reader.hpp"

#include <algorithm>
#include <cstring>

namespace gdtslam {
namespace {
// Small at first for short inputs, and doubled while reads fill it.
constexpr std::size_t kInitialBytes = std::size_t{1} << 13U;
constexpr std::size_t kUsualBytes = std::size_t{1} << 18U;
}  // namespace

LineReader::LineReader(std::unique_ptr<ByteSource> source, std::size_t max_line_bytes)
    : source_(std::move(source)), max_line_bytes_(max_line_bytes), buffer_(kInitialBytes) {}

bool LineReader::fill() {
  if (source_ended_) {
    return false;
  }
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size() || (is_filled_ && buffer_.size() < kUsualBytes)) {
    buffer_.resize(buffer_.size() * 2);
  }
  const std::size_t count = source_->read(std::span(buffer_).subspan(end_));
  end_ += count;
  is_filled_ = end_ == buffer_.size();
  source_ended_ = count == 0;
  return count > 0;
}

TextLine LineReader::take(std::size_t length, std::size_t consumed, bool has_newline) {
  const char* const text = buffer_.data() + begin_;
  begin_ += consumed;
  if (length > 0 && text[length - 1] == '\r' && has_newline) {
    --length;
  }
  return {{text, length}, ++line_number_, has_newline, false};
}

std::optional<TextLine> LineReader::next() {
  if (inside_long_line_) {
    skip_rest_of_line();
  }
  std::size_t searched = 0;
  for (;;) {
    const std::size_t available = end_ - begin_;
    if (available > searched) {
      const char* const from = buffer_.data() + begin_ + searched;
      const void* const newline = std::memchr(from, '\n', available - searched);
      if (newline != nullptr) {
        const std::size_t length = searched + static_cast<std::size_t>(static_cast<const char*>(newline) - from);
        TextLine line = take(length, length + 1, true);
        line.is_too_long = length > max_line_bytes_;
        return line;
      }
      searched = available;
    }
    if (searched > max_line_bytes_) {
      TextLine line = take(searched, searched, false);
      line.is_too_long = true;
      inside_long_line_ = true;
      return line;
    }
    if (!fill()) {
      return available == 0 ? std::nullopt : std::optional(take(available, available, false));
    }
  }
}

std::uint64_t LineReader::skip_empty_lines() {
  if (inside_long_line_) {
    skip_rest_of_line();
  }
  do {
    const char* const from = buffer_.data() + begin_;
    const char* const end = buffer_.data() + end_;
    const auto count = static_cast<std::size_t>(std::find_if(from, end, [](char c) { return c != '\n'; }) - from);
    begin_ += count;
    line_number_ += count;
  } while (begin_ == end_ && fill());
  return line_number_;
}

void LineReader::skip_rest_of_line() {
  inside_long_line_ = false;
  for (;;) {
    const char* const from = buffer_.data() + begin_;
    const void* const newline = end_ > begin_ ? std::memchr(from, '\n', end_ - begin_) : nullptr;
    if (newline != nullptr) {
      begin_ += static_cast<std::size_t>(static_cast<const char*>(newline) - from) + 1;
      return;
    }
    begin_ = end_;
    if (!fill()) {
      return;
    }
  }
}

std::string_view LineReader::peek(std::size_t bytes) {
  const auto available = [this] { return std::string_view(buffer_.data() + begin_, end_ - begin_); };
  while (available().size() < bytes && available().find('\n') == std::string_view::npos && fill()) {
  }
  return available().substr(0, bytes);
}

std::string_view LineReader::some(std::size_t most) {
  if (peek_bytes(1) == nullptr) return {};
  const std::size_t count = std::min(most, end_ - begin_);
  begin_ += count;
  return {buffer_.data() + begin_ - count, count};
}

}  // namespace gdtslam
