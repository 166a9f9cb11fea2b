#include "markup.hpp"

#include <cstddef>

#include "letters.hpp"

namespace gdtslam {
namespace {

bool is_allowed(char32_t code) {
  if (code < 0x20U) return code == '\n' || code == '\t';
  return code != 0x7FU && code != 0xFFFEU && code != 0xFFFFU;
}

}  // namespace

std::string clean_utf8(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Letter letter = next_letter(text, at);
    out += letter.code != kUnknownLetter && is_allowed(letter.code) ? letter.bytes : kUnknownLetterBytes;
  }
  return out;
}

std::string markup_text(std::string_view text) {
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

}  // namespace gdtslam
