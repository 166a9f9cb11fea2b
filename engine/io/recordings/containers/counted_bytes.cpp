#include "counted_bytes.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>

namespace gdtslam {

bool CountedBytes::fill() {
  if (has_crc_) (void)crc();
  crc_begin_ = 0;
  begin_ = 0;
  if (end_ == buffer_.size() && end_ < kPieceBytes) buffer_.resize(2 * end_);
  end_ = source_->read(buffer_);
  return end_ > 0;
}

std::size_t CountedBytes::read_some(std::span<char> target) {
  if (target.empty() || at_end()) return 0;
  const std::size_t count = std::min(target.size(), end_ - begin_);
  std::memcpy(target.data(), buffer_.data() + begin_, count);
  consume(count);
  return count;
}

void CountedBytes::read(std::span<char> target) {
  while (!target.empty()) {
    const std::size_t count = read_some(target);
    if (count == 0) throw RecordingCut("ends in the middle of a record");
    target = target.subspan(count);
  }
}

void CountedBytes::read_into(std::string& text, std::uint64_t count, std::size_t limit, const char* what) {
  if (count > limit) throw RecordingFault(fmt::format("has {} of {} bytes; at most {} are read", what, count, limit));
  text.clear();
  while (text.size() < count) {
    if (at_end()) throw RecordingCut("ends in the middle of a record");
    const std::size_t step = std::min<std::size_t>(static_cast<std::size_t>(count) - text.size(), end_ - begin_);
    text.append(buffer_.data() + begin_, step);
    consume(step);
  }
}

std::string CountedBytes::read_text(std::uint64_t count, std::size_t limit, const char* what) {
  std::string text;
  read_into(text, count, limit, what);
  return text;
}

void CountedBytes::skip(std::uint64_t count) {
  while (count > 0) {
    if (at_end()) throw RecordingCut("ends in the middle of a record");
    const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(count, end_ - begin_));
    consume(step);
    count -= step;
  }
}

void CountedBytes::start_crc() {
  has_crc_ = true;
  crc_ = 0;
  crc_begin_ = begin_;
}

std::uint32_t CountedBytes::crc() {
  const auto* const fresh = reinterpret_cast<const Bytef*>(buffer_.data()) + crc_begin_;
  crc_ = static_cast<std::uint32_t>(crc32_z(crc_, fresh, begin_ - crc_begin_));
  crc_begin_ = begin_;
  return crc_;
}

}  // namespace gdtslam
