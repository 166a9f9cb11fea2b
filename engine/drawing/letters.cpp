#include "letters.hpp"

#include <cstdint>

namespace gdtslam {
namespace {

std::uint32_t byte_at(std::string_view text, std::size_t k) { return static_cast<unsigned char>(text[k]); }

/// Sequence length announced by a first byte; 0 for an invalid one.
std::size_t announced_length(std::uint32_t first) {
  if (first < 0x80U) return 1;
  if (first >= 0xC2U && first < 0xE0U) return 2;
  if (first >= 0xE0U && first < 0xF0U) return 3;
  return first >= 0xF0U && first < 0xF5U ? 4U : 0U;
}

/// Bounds of the second byte exclude overlong forms, surrogates and codes above U+10FFFF (Unicode, table 3-7).
bool is_second_byte(std::uint32_t first, std::uint32_t second) {
  const std::uint32_t least = first == 0xE0U ? 0xA0U : first == 0xF0U ? 0x90U : 0x80U;
  const std::uint32_t most = first == 0xEDU ? 0x9FU : first == 0xF4U ? 0x8FU : 0xBFU;
  return second >= least && second <= most;
}

/// Number of valid bytes of the character at k, and whether it is complete.
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

}  // namespace

Letter next_letter(std::string_view words, std::size_t& at) {
  const Sequence sequence = sequence_at(words, at);
  const std::string_view bytes = words.substr(at, sequence.bytes);
  at += sequence.bytes;
  if (!sequence.is_whole) return {kUnknownLetter, bytes};
  char32_t code = bytes.size() == 1 ? byte_at(bytes, 0) : byte_at(bytes, 0) & (0x7FU >> bytes.size());
  for (std::size_t k = 1; k < bytes.size(); ++k) code = code << 6U | (byte_at(bytes, k) & 0x3FU);
  return {code, bytes};
}

bool is_utf8(std::string_view words) {
  for (std::size_t at = 0; at < words.size();) {
    const Sequence sequence = sequence_at(words, at);
    if (!sequence.is_whole) return false;
    at += sequence.bytes;
  }
  return true;
}

std::string legible(std::string_view words) {
  std::string result;
  for (std::size_t at = 0; at < words.size();) {
    const Letter letter = next_letter(words, at);
    if (letter.code < 0x20 || (letter.code >= 0x7F && letter.code < 0xA0)) {
      result += ' ';
    } else if (letter.code >= kUnknownLetter && letter.code <= 0xFFFF) {  // U+FFFE and U+FFFF are no characters
      result += kUnknownLetterBytes;
    } else {
      result += letter.bytes;
    }
  }
  return result;
}

std::string markup_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
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

}  // namespace gdtslam
