#include "page/page_escape.hpp"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace gdtslam::page {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

std::uint32_t byte_at(std::string_view text, std::size_t k) { return static_cast<unsigned char>(text[k]); }

/// Length of the sequence that a first byte announces; 0 where none begins so.
std::size_t announced_length(std::uint32_t first) {
  if (first < 0x80U) return 1;
  if (first >= 0xC2U && first < 0xE0U) return 2;
  if (first >= 0xE0U && first < 0xF0U) return 3;
  return first >= 0xF0U && first < 0xF5U ? 4U : 0U;
}

/// The second byte's bounds keep out overlong forms, surrogates and what is beyond U+10FFFF (Unicode, table 3-7).
bool is_second_byte(std::uint32_t first, std::uint32_t second) {
  const std::uint32_t least = first == 0xE0U ? 0xA0U : first == 0xF0U ? 0x90U : 0x80U;
  const std::uint32_t most = first == 0xEDU ? 0x9FU : first == 0xF4U ? 0x8FU : 0xBFU;
  return second >= least && second <= most;
}

/// Bytes of the character at k that are as they should be, and whether it is whole.
struct Sequence {
  std::size_t bytes = 1;
  bool is_whole = false;
};
Sequence sequence_at(std::string_view text, std::size_t k) {
  const std::uint32_t first = byte_at(text, k);
  const std::size_t length = announced_length(first);
  if (length == 0) return {};
  std::size_t good = 1;
  while (good < length && k + good < text.size()) {
    const std::uint32_t next = byte_at(text, k + good);
    if (good == 1 ? !is_second_byte(first, next) : (next & 0xC0U) != 0x80U) break;
    ++good;
  }
  return {good, good == length};
}

bool is_control(std::uint32_t byte) { return (byte < 0x20U && byte != '\n' && byte != '\t') || byte == 0x7FU; }

std::string unicode_escape(std::uint32_t code) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out = "\\u";
  for (int shift = 12; shift >= 0; shift -= 4) {
    out += kDigits[code >> static_cast<unsigned>(shift) & 0xFU];
  }
  return out;
}

}  // namespace

std::string clean_utf8(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t k = 0; k < text.size();) {
    const Sequence sequence = sequence_at(text, k);
    const bool is_good = sequence.is_whole && !is_control(byte_at(text, k));
    out += is_good ? text.substr(k, sequence.bytes) : kReplacement;
    k += sequence.bytes;
  }
  return out;
}

std::string html_text(std::string_view text) {
  std::string out;
  for (const char c : clean_utf8(text)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string json_text(std::string_view text) {
  constexpr std::string_view kEscaped = "\"\\<>&";
  std::string out = "\"";
  for (const char c : clean_utf8(text)) {
    const std::uint32_t byte = static_cast<unsigned char>(c);
    if (byte < 0x20U || kEscaped.find(c) != std::string_view::npos) {
      out += unicode_escape(byte);
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string json_number(double value) {
  if (!std::isfinite(value)) return "null";
  char digits[32];
  const std::to_chars_result end = std::to_chars(digits, digits + sizeof digits, value);
  return {digits, end.ptr};
}

void JsonWriter::begin(std::string_view key) {
  if (needs_comma_) out_ += ',';
  needs_comma_ = true;
  if (!key.empty()) out_.append("\"").append(key).append("\":");
}

JsonWriter& JsonWriter::open(std::string_view key, char bracket) {
  begin(key);
  out_ += bracket;
  closers_ += bracket == '{' ? '}' : ']';
  needs_comma_ = false;
  return *this;
}

JsonWriter& JsonWriter::close() {
  out_ += closers_.back();
  closers_.pop_back();
  needs_comma_ = true;
  return *this;
}

JsonWriter& JsonWriter::text(std::string_view key, std::string_view value) {
  begin(key);
  out_ += json_text(value);
  return *this;
}

JsonWriter& JsonWriter::number(std::string_view key, double value) {
  begin(key);
  out_ += json_number(value);
  return *this;
}

}  // namespace gdtslam::page
